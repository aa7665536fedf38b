// PETSc's objects with owners, and its errors.
#pragma once

#include <petscsys.h>

#include <stdexcept>
#include <utility>

namespace pliant::sim::distributed {

/// A library gave out: no memory, no disk, no partner. Mostly on one rank alone, while the others wait for it, so that
/// nobody up the stack has an answer: the program ends all ranks with this line. The one exception of this room.
class LibraryFailure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Throws LibraryFailure where a call into PETSc or MPI did not succeed. Their handlers have said no more before than
/// what the program has let them.
void must(int code);

/// Destroys a PETSc object at the end of its life.
template <class T, PetscErrorCode (*destroy)(T*)>
class Owned {
public:
    Owned() = default;
    Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
    Owned& operator=(Owned&& other) noexcept {
        std::swap(object_, other.object_);
        return *this;
    }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
    ~Owned() {
        if (object_ != nullptr) destroy(&object_);
    }
    [[nodiscard]] T get() const { return object_; }
    /// Where a function of PETSc writes a new one.
    [[nodiscard]] T* fill() {
        if (object_ != nullptr) destroy(&object_);
        object_ = nullptr;
        return &object_;
    }

private:
    T object_ = nullptr;
};

}  // namespace pliant::sim::distributed
