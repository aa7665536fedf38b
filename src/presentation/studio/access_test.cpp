// Access control: a table of requests from browsers and others.
#include "presentation/studio/access.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace pliant::studio;

namespace {

Credentials from(std::string_view host, std::string_view origin = "", bool websocket = false) {
    Credentials c;
    c.host = host;
    c.origin = origin;
    c.websocket = websocket;
    return c;
}

}  // namespace

TEST_CASE("the page may show pictures of one address more, and of nothing that is no address") {
    CHECK(origin_of("http://camera:8080/stream?fps=5") == "http://camera:8080");
    CHECK(origin_of("https://192.168.0.7") == "https://192.168.0.7");
    CHECK(origin_of("http://[::1]:81/a.jpg") == "http://[::1]:81");
    for (const char* wrong : {"", "camera", "ftp://camera/a", "http://", "http://a b/", "http://a;script-src *",
                              "http://*/x", "http://user@camera/", "javascript:alert(1)"})
        CHECK(origin_of(wrong) == "");
}

TEST_CASE("loopback lets its own page in, under each of its names") {
    const AccessRules rules{7117, ""};
    for (const char* host : {"localhost:7117", "127.0.0.1:7117", "[::1]:7117"}) {
        CHECK(check_access(rules, from(host)) == Access::granted);
        CHECK(check_access(rules, from(host, std::string("http://") + host)) == Access::granted);
        CHECK(check_access(rules, from(host, std::string("http://") + host, true)) == Access::granted);
    }
}

TEST_CASE("a name that was made to point here is refused") {
    const AccessRules rules{7117, ""};
    for (const char* host : {"", "evil.example", "evil.example:7117", "localhost", "localhost:80", "127.0.0.1:71170",
                             "localhost:7117.evil.example"})
        CHECK_MESSAGE(check_access(rules, from(host)) == Access::wrong_host, host);
    CHECK(check_access({80, ""}, from("localhost")) == Access::granted);
}

TEST_CASE("pages of others are refused, and a WebSocket must say where it comes from") {
    const AccessRules rules{7117, ""};
    for (const char* origin : {"http://evil.example", "https://localhost:7117", "http://localhost:7118", "null",
                               "http://localhost:7117.evil.example", "http://127.0.0.1:7117"})
        CHECK_MESSAGE(check_access(rules, from("localhost:7117", origin)) == Access::wrong_origin, origin);
    CHECK(check_access(rules, from("localhost:7117", "", true)) == Access::wrong_origin);
}

TEST_CASE("bound elsewhere the token decides, however it comes") {
    const AccessRules rules{7117, "abcDEF123"};
    Credentials c = from("printer.lan:7117", "http://printer.lan:7117");
    CHECK(check_access(rules, c) == Access::no_token);
    for (const char* wrong : {"abcDEF124", "abcDEF12", "abcDEF1234", ""}) {
        c.bearer = wrong;
        CHECK(check_access(rules, c) == Access::no_token);
    }
    c.bearer = "abcDEF123";
    CHECK(check_access(rules, c) == Access::granted);
    c = from("printer.lan:7117");
    c.query_token = "abcDEF123";
    CHECK(check_access(rules, c) == Access::granted);
    c = from("printer.lan:7117");
    c.cookie = "a=b; pliant_token=abcDEF123; c=d";
    CHECK(check_access(rules, c) == Access::granted);
    c.cookie = "xpliant_token=abcDEF123";
    CHECK(check_access(rules, c) == Access::no_token);
    c.cookie = "pliant_token=abcDEF123";
    c.origin = "http://evil.example";
    CHECK(check_access(rules, c) == Access::wrong_origin);
}

TEST_CASE("keys are long and never the same") {
    std::set<std::string> keys;
    for (int i = 0; i < 50; ++i) keys.insert(random_key());
    CHECK(keys.size() == 50);
    CHECK(keys.begin()->size() == 32);
}
