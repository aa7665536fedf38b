// The studio as a server: HTTP and WebSocket through civetweb, on loopback unless bound elsewhere.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/core/error.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {

struct ServerSettings {
    std::string address = "127.0.0.1";
    int port = 0;                  ///< 0: any free port
    std::string token;             ///< required from every page; must not be empty unless the address is loopback
    bool token_from_file = false;  ///< not part of the address that is printed
    std::filesystem::path program_folder{};  ///< used to find the pages of /help/
};

class Server {
public:
    /// The server is listening when this returns. Errors: the port is taken, no such address.
    [[nodiscard]] static Result<std::unique_ptr<Server>> start(Studio& studio, const ServerSettings& settings);
    /// Closes all connections and waits for their threads.
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] int port() const;

private:
    struct State;
    struct LivePath;
    [[nodiscard]] static Status listen(State& state, const ServerSettings& settings);
    explicit Server(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

void use_large_thread_stacks();  // thread_stacks.cpp

[[nodiscard]] bool is_loopback(const std::string& address);

}  // namespace pliant::studio
