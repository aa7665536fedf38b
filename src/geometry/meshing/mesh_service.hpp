// What pliant-mesh does: answers requests until nobody asks any more.
#pragma once

#include "geometry/mesher/message_pipe.hpp"

namespace pliant::mesh {

/// The answer to one request: MessageKind::answer or error. `pipe` is told of progress on the way.
[[nodiscard]] Message answer_request(const Message& request, const MessagePipe& pipe);

/// Greets, then answers one request after the other until the other end closes.
void serve_meshes(MessagePipe pipe);

}  // namespace pliant::mesh
