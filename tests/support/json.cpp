#include "support/json.h"

template class nlohmann::basic_json<>;

namespace tufa::test {

nlohmann::json parseJson(const std::string& text) { return nlohmann::json::parse(text); }

}  // namespace tufa::test
