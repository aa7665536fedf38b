#include "studio/server/server.hpp"

#include <arpa/inet.h>
#include <civetweb.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <stop_token>
#include <thread>

#include "studio/base/access.hpp"
#include "studio/built_in/examples.hpp"
#include "studio/requests/frame_reader.hpp"
#include "studio/server/crowd.hpp"
#include "studio/server/hang_up.hpp"
#include "studio/server/help_pages.hpp"

namespace pliant::studio {
namespace {

std::string_view header(mg_connection* wire, const char* name) {
    const char* value = mg_get_header(wire, name);
    return value != nullptr ? value : "";
}

const char* reason(int status) {
    switch (status) {
        case 200:
            return "OK";
        case 204:
            return "No Content";
        case 302:
            return "Found";
        case 400:
            return "Bad Request";
        case 401:
            return "Unauthorized";
        case 403:
            return "Forbidden";
        case 404:
            return "Not Found";
        case 405:
            return "Method Not Allowed";
        case 409:
            return "Conflict";
        case 413:
            return "Content Too Large";
        case 422:
            return "Unprocessable Content";
        case 423:
            return "Locked";
        default:
            return "Error";
    }
}

/// Security headers: no content from elsewhere, no embedding in other pages, no MIME sniffing.
constexpr const char* safety_headers =
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Content-Security-Policy: default-src 'self'; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; img-src "
    "'self' blob: data:";

void write(mg_connection* wire, const Response& response, const std::string& more = "") {
    std::string head = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{}{}{}\r\n",
                                   response.status, reason(response.status), response.type, response.body.size(),
                                   safety_headers, response.images_from.empty() ? "" : " ", response.images_from);
    head += response.keep ? "Cache-Control: private, max-age=31536000, immutable\r\n" : "Cache-Control: no-store\r\n";
    if (response.packed) head += "Content-Encoding: gzip\r\n";
    if (!response.file_name.empty())
        head += fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n", response.file_name);
    if (!response.location.empty()) head += fmt::format("Location: {}\r\n", response.location);
    head += more + "\r\n";
    mg_write(wire, head.data(), head.size());
    if (!response.body.empty()) mg_write(wire, response.body.data(), response.body.size());
}

std::map<std::string, std::string> read_query(const char* text) {
    std::map<std::string, std::string> query;
    std::string_view rest = text != nullptr ? text : "";
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('&'), rest.size());
        const std::string_view one = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        const std::size_t equals = std::min(one.find('='), one.size());
        std::string value(one.substr(std::min(equals + 1, one.size())));
        std::string plain(value.size() + 1, '\0');
        const int length = mg_url_decode(value.data(), static_cast<int>(value.size()), plain.data(),
                                         static_cast<int>(plain.size()), 1);
        plain.resize(static_cast<std::size_t>(std::max(length, 0)));
        query.emplace(one.substr(0, equals), std::move(plain));
    }
    return query;
}

/// Reads the whole body; false if it is too large or incomplete.
bool read_body(mg_connection* wire, long long length, std::string& body) {
    if (length > largest_body) return false;
    char piece[16384];
    while (static_cast<long long>(body.size()) <= largest_body) {
        if (length >= 0 && static_cast<long long>(body.size()) >= length) return true;
        const int got = mg_read(wire, piece, sizeof piece);
        if (got <= 0) return length < 0;
        body.append(piece, static_cast<std::size_t>(got));
    }
    return false;
}

/// Each page that watches keeps a thread of the server; the others are for requests, such as an emergency stop.
constexpr const char* threads = "96";
constexpr int most_pages = 64;

/// The library would take 999.1.1.1 for 231.1.1.1.
bool may_be_address(const std::string& address) {
    in6_addr bytes{};
    if (address.find(':') != std::string::npos) return ::inet_pton(AF_INET6, address.c_str(), &bytes) == 1;
    if (address.find_first_not_of("0123456789.") != std::string::npos) return true;  // a name
    return ::inet_pton(AF_INET, address.c_str(), &bytes) == 1;
}

}  // namespace

bool is_loopback(const std::string& address) {
    return address == "127.0.0.1" || address == "::1" || address == "localhost";
}

struct Server::State {
    Studio& studio;
    AccessRules rules;
    std::filesystem::path help;  ///< empty: no help pages
    mg_context* context = nullptr;
    std::atomic<int> pages = 0;  ///< that watch
    Crowd crowd{};

    [[nodiscard]] Access access(mg_connection* wire, const std::string& query_token, bool websocket) const {
        std::string_view bearer = header(wire, "Authorization");
        bearer = bearer.starts_with("Bearer ") ? bearer.substr(7) : "";
        return check_access(rules, {header(wire, "Host"), header(wire, "Origin"), header(wire, "Cookie"), bearer,
                                    query_token, websocket});
    }

    int handle(mg_connection* wire) const {
        const mg_request_info& info = *mg_get_request_info(wire);
        Request request{info.request_method, info.local_uri_raw != nullptr ? info.local_uri_raw : "",
                        read_query(info.query_string)};
        const std::string token = request.query.contains("token") ? request.query["token"] : "";
        const Access right = access(wire, token, false);
        if (right != Access::granted) {
            const bool lacks_token = right == Access::no_token || right == Access::wrong_token;
            return refuse(wire, lacks_token ? 401 : 403, refusal_text(rules, right));
        }
        if (!token.empty() && request.method == "GET" && request.path == "/") return settle_token(wire, token);
        request.page = header(wire, "X-Pliant-Page");
        if (studio.streams(request)) {
            request.length = info.content_length;
            request.more = [wire](char* into, std::size_t most) -> long long { return mg_read(wire, into, most); };
            return answer(wire, studio.handle(request));
        }
        if (request.method != "GET" && !read_body(wire, info.content_length, request.body))
            return refuse(wire, 413, "more than 4 MB are refused");
        if (request.path.starts_with("/api/")) return answer(wire, studio.handle(request));
        if (request.method == "GET" && (request.path == "/help" || request.path.starts_with("/help/")))
            return answer(wire, help_page(help, request.path));
        Response page = page_file(request);
        page.images_from = origin_of(studio.webcam());
        return answer(wire, page);
    }

    static int refuse(mg_connection* wire, int status, const char* text) {
        return answer(wire, error_response(status, text));
    }
    static int answer(mg_connection* wire, const Response& response) {
        write(wire, response);
        return response.status;
    }

    /// Moves the token from the address into a cookie, so that it does not stay in the history.
    /// An address with another token, as in an old bookmark, does not replace a valid cookie.
    [[nodiscard]] int settle_token(mg_connection* wire, const std::string& token) const {
        Response response{302, "text/plain"};
        response.location = "/";
        const bool is_ours = !rules.token.empty() && token == rules.token;
        write(wire, response,
              is_ours ? fmt::format("Set-Cookie: {}={}; HttpOnly; SameSite=Strict; Path=/\r\n", cookie_name(rules),
                                    rules.token)
                      : std::string());
        return 302;
    }

    static Response page_file(const Request& request) {
        if (request.method != "GET") return error_response(405, "method not allowed");
        for (const PageFile& file : page_files()) {
            if (file.path != request.path) continue;
            Response response{200, std::string(file.type), std::string(file.bytes)};
            response.packed = file.packed;
            response.keep = file.path != "/";
            return response;
        }
        return error_response(404, "not found");
    }
};

namespace {

/// State of one WebSocket: its connection in the hub and the thread that writes.
struct Socket {
    std::shared_ptr<Connection> connection;
    FrameReader reader{};
    std::atomic<CloseCode> code = CloseCode::going_away;  ///< told when it closes
    std::thread writer{};
};

void write_all(mg_connection* wire, const Socket& socket) {
    while (const auto out = socket.connection->next()) {
        const int opcode = out->binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT;
        if (mg_websocket_write(wire, opcode, out->bytes->data(), out->bytes->size()) <= 0) return;
    }
    const std::string code = close_payload(socket.code);
    mg_websocket_write(wire, MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE, code.data(), code.size());
}

/// The library looks up to two seconds later whether it should stop, wherever it waits for a connection or a request.
void stop(mg_context* context, int port) {
    std::jthread calls([port](const std::stop_token& stopped) {
        while (!stopped.stop_requested()) {
            hang_up(port);
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    });
    mg_stop(context);
}

}  // namespace

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}

Server::~Server() {
    state_->studio.close();
    if (port() > 0)
        stop(state_->context, port());
    else if (state_->context != nullptr)
        mg_stop(state_->context);
    mg_exit_library();
}

int Server::port() const {
    return state_->rules.port;
}

/// The callbacks of /live; `data` is the server's state.
struct Server::LivePath {
    static int admit(const mg_connection* wire, void* data) {
        auto query = read_query(mg_get_request_info(wire)->query_string);
        const auto* state = static_cast<State*>(data);
        if (std::any_of(query.begin(), query.end(), [](const auto& one) { return one.first != "token"; })) return 1;
        if (state->pages >= most_pages) return 1;
        return state->access(const_cast<mg_connection*>(wire), query["token"], true) == Access::granted ? 0 : 1;
    }
    static void open(mg_connection* wire, void* data) {
        auto* state = static_cast<State*>(data);
        ++state->pages;
        auto* socket = new Socket{state->studio.join()};
        socket->writer = std::thread(write_all, wire, std::cref(*socket));
        mg_set_user_connection_data(wire, socket);
    }
    static int receive(mg_connection* wire, int bits, char* text, std::size_t length, void* data) {
        auto* socket = static_cast<Socket*>(mg_get_user_connection_data(wire));
        const FrameDeed deed = socket->reader.take(bits, {text, length});
        switch (deed.kind) {
            case FrameDeed::Kind::nothing:
                break;
            case FrameDeed::Kind::text:
                static_cast<State*>(data)->studio.receive(socket->connection, deed.bytes);
                break;
            case FrameDeed::Kind::pong:
                return mg_websocket_write(wire, MG_WEBSOCKET_OPCODE_PONG, deed.bytes.data(), deed.bytes.size()) > 0;
            case FrameDeed::Kind::close:
                socket->code = deed.code;
                return 0;
        }
        return 1;
    }
    static void close(const mg_connection* wire, void* data) {
        auto* socket = static_cast<Socket*>(mg_get_user_connection_data(wire));
        if (socket == nullptr) return;
        auto* state = static_cast<State*>(data);
        state->studio.leave(socket->connection);
        socket->writer.join();
        --state->pages;
        delete socket;
        mg_set_user_connection_data(wire, nullptr);
    }
};

Result<std::unique_ptr<Server>> Server::start(Studio& studio, const ServerSettings& settings) {
    use_large_thread_stacks();
    mg_init_library(MG_FEATURES_DEFAULT);
    std::unique_ptr<Server> server(new Server(std::unique_ptr<State>(
        new State{studio, {0, settings.token, settings.token_from_file}, find_help_pages(settings.program_folder)})));
    State* state = server->state_.get();
    if (Status status = listen(*state, settings); !status) return tl::unexpected(status.error());
    // Without the sign for its end, the pattern takes /livex too.
    mg_set_websocket_handler(state->context, "/live$", LivePath::admit, LivePath::open, LivePath::receive,
                             LivePath::close, state);
    mg_set_request_handler(
        state->context, "/", [](mg_connection* wire, void* data) { return static_cast<State*>(data)->handle(wire); },
        state);
    return server;
}

Status Server::listen(State& state, const ServerSettings& settings) {
    if (!may_be_address(settings.address))
        return input_error("{}: is not an address such as 127.0.0.1, 0.0.0.0 or ::1", settings.address);
    const bool six = settings.address.find(':') != std::string::npos;
    const std::string ports =
        fmt::format("{}:{}", six ? "[" + settings.address + "]" : settings.address, settings.port);
    // Without linger_timeout_ms: with 0 the library's closing would throw away what is written and not yet sent.
    // clang-format off
    const char* options[] = {"listening_ports", ports.c_str(),
                             "num_threads", threads,
                             "request_timeout_ms", "10000",
                             "websocket_timeout_ms", "20000",
                             "enable_keep_alive", "yes",
                             "keep_alive_timeout_ms", "5000",
                             "tcp_nodelay", "1",
                             nullptr};
    // clang-format on
    mg_callbacks callbacks{};
    // From the end of a request's head to the end of its answer, or of the connection of a page that watches.
    callbacks.begin_request = [](mg_connection* wire) {
        const mg_request_info& info = *mg_get_request_info(wire);
        static_cast<State*>(info.user_data)->crowd.begin({info.remote_addr, info.remote_port});
        return 0;
    };
    callbacks.end_request = [](const mg_connection* wire, int) {
        const mg_request_info& info = *mg_get_request_info(wire);
        static_cast<State*>(info.user_data)->crowd.end({info.remote_addr, info.remote_port});
    };
    callbacks.log_message = [](const mg_connection*, const char*) { return 1; };  // the library never prints
    state.context = mg_start(&callbacks, &state, options);
    mg_server_port listening[4];
    const int count = state.context == nullptr ? 0 : mg_get_server_ports(state.context, 4, listening);
    if (count < 1)
        return failure("{}: cannot listen there; the port is taken, or the address is not this machine's", ports);
    state.rules.port = listening[0].port;
    state.crowd.watch(state.rules.port);
    return {};
}

}  // namespace pliant::studio
