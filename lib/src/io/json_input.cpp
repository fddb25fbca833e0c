#include "io/json_input.h"

namespace tufa::io {

void requireShallowJson(std::string_view text, const InputBytes& input) {
  constexpr std::size_t kDeepest = 100;
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const char c = text[n];
    if (quoted) {
      if (c == '\\') ++n;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest) input.fail("its JSON is nested deeper than 100 levels");
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
}

}  // namespace tufa::io
