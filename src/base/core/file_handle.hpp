// An open file, pipe, socket or device of the system, which is closed with its owner.
#pragma once

#include <utility>

namespace pliant {

/// Owns a file descriptor; movable. Whatever was moved from owns none, or after an assignment that of the other.
class FileHandle {
public:
    FileHandle() = default;
    /// Below zero, as the system's calls say that they failed: none.
    explicit FileHandle(int number) : number_(number) {}
    FileHandle(FileHandle&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    FileHandle& operator=(FileHandle&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~FileHandle() { close(); }

    [[nodiscard]] bool is_open() const { return number_ >= 0; }
    /// For the system's calls; still owned here.
    [[nodiscard]] int number() const { return number_; }
    /// Does nothing where there is none. errno stays as it is.
    void close() noexcept;

private:
    int number_ = -1;
};

}  // namespace pliant
