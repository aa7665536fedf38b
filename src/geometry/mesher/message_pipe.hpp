// Messages between a program and its mesher process: a kind, a length, bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/core/file_handle.hpp"

namespace pliant::mesh {

/// Sent by both ends; a different version is refused. Must change with every format change in packing.hpp.
inline constexpr std::string_view mesher_greeting = "pliant-mesh 1";

enum class MessageKind : std::uint8_t {
    greeting,     ///< first message of the mesher: mesher_greeting
    mesh_bodies,  ///< bodies, settings; answered by a TetMesh
    tessellate,   ///< solid, tolerance; by a TriMesh
    volume,       ///< solid; by a number
    read_step,    ///< file, scale; by a StepContent
    notches,      ///< surface, path; by a list of notches
    progress,     ///< from the mesher, at any time: stage, fraction
    answer,       ///< the result of the request
    error,        ///< cause, text
};

struct Message {
    MessageKind kind = MessageKind::error;
    std::string bytes;
};

/// The outcome of receive().
enum class Received { message, closed, waiting };

/// One end of a connected socket pair, closed by the destructor. Movable.
class MessagePipe {
public:
    explicit MessagePipe(int file) : file_(file) {}

    [[nodiscard]] int file() const { return file_.number(); }
    /// False if the other end is closed.
    [[nodiscard]] bool send(MessageKind kind, std::string_view bytes) const;
    /// Waits this long at most; forever if negative. A partly received message is kept for the next call; memory
    /// follows the bytes received, not the length announced.
    [[nodiscard]] Received receive(Message& message, int wait_ms);

private:
    [[nodiscard]] bool take_message(Message& message);

    FileHandle file_;
    std::string come_;
};

}  // namespace pliant::mesh
