#include "simulation/distributed/petsc.hpp"

#include <fmt/format.h>

#include <string>

namespace pliant::sim::distributed {

void must(int code) {
    if (code == 0) return;
    const char* text = nullptr;
    char* own = nullptr;  // what was said of this one error
    PetscErrorMessage(static_cast<PetscErrorCode>(code), &text, &own);
    const std::string own_words = own != nullptr ? own : "";
    throw LibraryFailure(fmt::format("PETSc: {}{}{} (error {})", text != nullptr ? text : "a library failed",
                                     own_words.empty() ? "" : ": ", own_words, code));
}

}  // namespace pliant::sim::distributed
