#include "io/json_input.h"

namespace tufa::io {

void failAsNoJson(std::string_view message, const InputBytes& input) {
  // "[json.exception.parse_error.101] parse error at line 1, column 8: syntax error while ..."
  constexpr std::string_view kError = "parse error ";
  const std::size_t at = message.find(kError);
  if (at != std::string_view::npos) message.remove_prefix(at + kError.size());
  input.fail("its JSON is damaged " + std::string(message));
}

void requireShallowJson(std::string_view text, const InputBytes& input) {
  // JSON has no byte of value 0, other files mostly do, such as .vdb.
  if (text.substr(0, 64).find('\0') != std::string_view::npos) {
    input.fail("it is a binary file where JSON is due");
  }
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
