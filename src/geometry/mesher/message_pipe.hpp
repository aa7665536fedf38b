// Messages between a program and its mesher process: a kind, a length, bytes.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "base/core/file_handle.hpp"

namespace pliant::mesh {

/// Sent by both ends; a different version is refused. Must change with every format change in packing.hpp.
inline constexpr std::string_view mesher_greeting = "pliant-mesh 2";

/// A request can ask for so many ways to place the seams of round shapes, 0 to 3; the usual one is 0.
inline constexpr std::uint8_t seam_ways = 4;

enum class MessageKind : std::uint8_t {
    greeting,     ///< first message of the mesher: mesher_greeting
    mesh_bodies,  ///< bodies, settings; way of seams; answered by a TetMesh
    tessellate,   ///< solid, tolerance, way of seams; by a TriMesh
    volume,       ///< solid, way of seams; by a number
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
enum class Received { message, closed, waiting, too_large };

/// One end of a connected socket pair, closed by the destructor. Movable.
class MessagePipe {
public:
    explicit MessagePipe(int file) : file_(file) {}

    [[nodiscard]] int file() const { return file_.number(); }
    /// False if the other end is closed.
    [[nodiscard]] bool send(MessageKind kind, std::string_view bytes) const;
    /// Waits this long at most, also while bytes come; forever if negative. A partly received message is kept for the
    /// next call; memory follows the bytes received, not the length announced. `too_large`: a message of over
    /// `most_bytes` is announced.
    [[nodiscard]] Received receive(Message& message, int wait_ms,
                                   std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

private:
    /// Of the message that comes; empty: not known yet.
    [[nodiscard]] std::optional<std::uint64_t> announced_size() const;
    [[nodiscard]] bool take_message(Message& message);

    FileHandle file_;
    std::string come_;
};

}  // namespace pliant::mesh
