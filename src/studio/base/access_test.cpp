// Access control: a table of requests from browsers and others.
#include "studio/base/access.hpp"

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

TEST_CASE("the page may load pictures from one other address; invalid addresses are refused") {
    CHECK(origin_of("http://camera:8080/stream?fps=5") == "http://camera:8080");
    CHECK(origin_of("https://192.168.0.7") == "https://192.168.0.7");
    CHECK(origin_of("http://[::1]:81/a.jpg") == "http://[::1]:81");
    for (const char* wrong : {"", "camera", "ftp://camera/a", "http://", "http://a b/", "http://a;script-src *",
                              "http://*/x", "http://user@camera/", "javascript:alert(1)"})
        CHECK(origin_of(wrong) == "");
}

TEST_CASE("on loopback the studio's own page is let in, under each name of this computer") {
    const AccessRules rules{7117, ""};
    for (const char* host : {"localhost:7117", "127.0.0.1:7117", "[::1]:7117"}) {
        CHECK(check_access(rules, from(host)) == Access::granted);
        CHECK(check_access(rules, from(host, std::string("http://") + host)) == Access::granted);
        CHECK(check_access(rules, from(host, std::string("http://") + host, true)) == Access::granted);
    }
}

TEST_CASE("a request with a foreign Host header is refused") {
    const AccessRules rules{7117, ""};
    for (const char* host : {"", "evil.example", "evil.example:7117", "localhost", "localhost:80", "127.0.0.1:71170",
                             "localhost:7117.evil.example"})
        CHECK_MESSAGE(check_access(rules, from(host)) == Access::wrong_host, host);
    CHECK(check_access({80, ""}, from("localhost")) == Access::granted);
}

TEST_CASE("requests from other sites' pages are refused, and a WebSocket needs an Origin") {
    const AccessRules rules{7117, ""};
    for (const char* origin : {"http://evil.example", "https://localhost:7117", "http://localhost:7118", "null",
                               "http://localhost:7117.evil.example", "http://127.0.0.1:7117"})
        CHECK_MESSAGE(check_access(rules, from("localhost:7117", origin)) == Access::wrong_origin, origin);
    CHECK(check_access(rules, from("localhost:7117", "", true)) == Access::wrong_origin);
}

TEST_CASE("bound to another address, access needs the right token, however it is sent") {
    const AccessRules rules{7117, "abcDEF123"};
    Credentials c = from("printer.lan:7117", "http://printer.lan:7117");
    CHECK(check_access(rules, c) == Access::no_token);
    for (const char* wrong : {"abcDEF124", "abcDEF12", "abcDEF1234"}) {
        c.bearer = wrong;
        CHECK(check_access(rules, c) == Access::wrong_token);
    }
    c.bearer = "";
    CHECK(check_access(rules, c) == Access::no_token);
    c.bearer = "abcDEF123";
    CHECK(check_access(rules, c) == Access::granted);
    c = from("printer.lan:7117");
    c.query_token = "abcDEF123";
    CHECK(check_access(rules, c) == Access::granted);
    c = from("printer.lan:7117");
    c.cookie = "a=b; pliant_token_7117=abcDEF123; c=d";
    CHECK(check_access(rules, c) == Access::granted);
    c.cookie = "xpliant_token_7117=abcDEF123";
    CHECK(check_access(rules, c) == Access::no_token);
    c.cookie = "pliant_token_7117=abcDEF124";
    CHECK(check_access(rules, c) == Access::wrong_token);
    c.cookie = "pliant_token_7117=abcDEF123";
    c.cookie = "pliant_token_7118=abcDEF124; pliant_token_7117=abcDEF123";  // of another studio on this host
    CHECK(check_access(rules, c) == Access::granted);
    c.origin = "http://evil.example";
    CHECK(check_access(rules, c) == Access::wrong_origin);
}

TEST_CASE("who is refused learns where the right token is") {
    const auto says = [](bool from_file, Access access, const char* part) {
        return std::string(refusal_text({7117, "abcDEF123", from_file}, access)).find(part) != std::string::npos;
    };
    CHECK(says(false, Access::no_token, "the token is missing: use the address that the studio printed"));
    CHECK(says(false, Access::wrong_token, "the token is wrong: use the address that the studio printed"));
    CHECK(says(true, Access::no_token, "add ?token=TOKEN to the address; the token is in the file"));
    CHECK(says(true, Access::wrong_token, "the token is wrong: it is in the file"));
}

TEST_CASE("page keys are long and all different") {
    std::set<std::string> keys;
    for (int i = 0; i < 50; ++i) keys.insert(random_key());
    CHECK(keys.size() == 50);
    CHECK(keys.begin()->size() == 32);
}
