// Messages over the pipe between a program and its mesher: a kind, a length, bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/core/file_handle.hpp"

namespace pliant::mesh {

/// Of both ends; another version is refused. Changes with everything that packing.hpp writes.
inline constexpr std::string_view mesher_greeting = "pliant-mesh 1";

enum class MessageKind : std::uint8_t {
    greeting,     ///< the mesher's first: mesher_greeting
    mesh_bodies,  ///< bodies, settings; answered by a TetMesh
    tessellate,   ///< solid, tolerance; by a TriMesh
    volume,       ///< solid; by a number
    read_step,    ///< file, scale; by a StepContent
    notches,      ///< surface, path; by a list of notches
    progress,     ///< from the mesher, at any time: stage, fraction
    answer,       ///< what was asked for
    error,        ///< cause, text
};

struct Message {
    MessageKind kind = MessageKind::error;
    std::string bytes;
};

/// How receive() ended.
enum class Received { message, closed, waiting };

/// One end of a connected pair of sockets; closed with it. Movable.
class MessagePipe {
public:
    explicit MessagePipe(int file) : file_(file) {}

    [[nodiscard]] int file() const { return file_.number(); }
    /// False where the other end is gone.
    [[nodiscard]] bool send(MessageKind kind, std::string_view bytes) const;
    /// Waits so long at most, or for ever where it is negative. What has come of a message is kept for the next call;
    /// memory follows the bytes that have come, not the length that is claimed.
    [[nodiscard]] Received receive(Message& message, int wait_ms);

private:
    [[nodiscard]] bool take_message(Message& message);

    FileHandle file_;
    std::string come_;
};

}  // namespace pliant::mesh
