#include "studio/base/http.hpp"

#include <nlohmann/json.hpp>

#include "studio/base/dumped.hpp"

namespace pliant::studio {

Response json_response(std::string json) {
    return {200, "application/json", std::move(json)};
}

Response error_response(const Error& error) {
    return error_response(error.cause == Cause::input ? 422 : 409, error.message);
}

Response error_response(int status, std::string_view text) {
    const nlohmann::json json = {{"error", text}};
    return {status, "application/json", dumped(json)};
}

Response done(const Status& status) {
    return status ? json_response("{}") : error_response(status.error());
}

}  // namespace pliant::studio
