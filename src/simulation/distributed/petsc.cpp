#include "simulation/distributed/petsc.hpp"

#include <fmt/format.h>
#include <petsclog.h>

#include <string>

namespace pliant::sim::distributed {

void must(int code) {
    if (code == 0) return;
    const char* text = nullptr;
    char* own = nullptr;  // the message of this error
    PetscErrorMessage(static_cast<PetscErrorCode>(code), &text, &own);
    const std::string own_words = own != nullptr ? own : "";
    throw LibraryFailure(fmt::format("PETSc: {}{}{} (error {})", text != nullptr ? text : "a library failed",
                                     own_words.empty() ? "" : ": ", own_words, code));
}

LogStage::LogStage(const char* name) {
    PetscLogStage stage = -1;
    must(PetscLogStageGetId(name, &stage));
    if (stage < 0) must(PetscLogStageRegister(name, &stage));
    must(PetscLogStagePush(stage));
}

LogStage::~LogStage() {
    PetscLogStagePop();
}

}  // namespace pliant::sim::distributed
