// Ownership of PETSc objects, and PETSc's errors.
#pragma once

#include <petscsys.h>

#include <stdexcept>
#include <utility>

namespace pliant::sim::distributed {

/// A library failed: no memory, no disk, no connection. This mostly happens on one rank while the others wait for it,
/// so that no caller can handle it: the program ends all ranks with this line. The only exception in this folder.
class LibraryFailure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Throws LibraryFailure if a call of PETSc or MPI failed.
void must(int code);

/// Owns a PETSc object.
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
    /// For functions of PETSc that create an object.
    [[nodiscard]] T* fill() {
        if (object_ != nullptr) destroy(&object_);
        object_ = nullptr;
        return &object_;
    }

private:
    T object_ = nullptr;
};

/// Names the work during its own lifetime in the tables of -log_view.
class LogStage {
public:
    explicit LogStage(const char* name);
    LogStage(const LogStage&) = delete;
    LogStage& operator=(const LogStage&) = delete;
    ~LogStage();
};

}  // namespace pliant::sim::distributed
