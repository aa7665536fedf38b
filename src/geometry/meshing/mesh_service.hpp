// The request loop of pliant-mesh.
#pragma once

#include "geometry/mesher/message_pipe.hpp"

namespace pliant::mesh {

/// The answer to one request: MessageKind::answer or error. Progress is sent to `pipe` meanwhile.
[[nodiscard]] Message answer_request(const Message& request, const MessagePipe& pipe);

/// Sends the greeting, then answers requests until the other end closes.
void serve_meshes(MessagePipe pipe);

}  // namespace pliant::mesh
