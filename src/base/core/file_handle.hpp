// An open file, pipe, socket or device of the system, closed by its owner's destructor.
#pragma once

#include <utility>

namespace pliant {

/// Owns a file descriptor; movable. A moved-from handle owns none; after a move assignment it owns the target's old
/// one.
class FileHandle {
public:
    FileHandle() = default;
    /// A negative number, the system's error result, means none.
    explicit FileHandle(int number) : number_(number) {}
    FileHandle(FileHandle&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    FileHandle& operator=(FileHandle&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~FileHandle() { close(); }

    [[nodiscard]] bool is_open() const { return number_ >= 0; }
    /// For system calls; ownership stays here.
    [[nodiscard]] int number() const { return number_; }
    /// Gives the descriptor to the caller.
    [[nodiscard]] int release() { return std::exchange(number_, -1); }
    /// Does nothing if no descriptor is owned. Preserves errno.
    void close() noexcept;

private:
    int number_ = -1;
};

}  // namespace pliant
