#include "studio/server/hang_up.hpp"

#include <sys/socket.h>

#include "studio/server/own_sockets.hpp"

namespace pliant::studio {

void hang_up(int port) {
    for (const int file : sockets_at(port)) shutdown(file, SHUT_RD);
}

}  // namespace pliant::studio
