#include "base/core/loaded_library.hpp"

#include <dlfcn.h>

namespace pliant {

LoadedLibrary::LoadedLibrary(const char* file_name)
    : name_(file_name), handle_(dlopen(file_name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) {}

void* LoadedLibrary::address_of(const char* name) {
    void* address = handle_ ? dlsym(handle_.get(), name) : nullptr;
    if (address == nullptr) handle_.reset();
    return address;
}

void LoadedLibrary::Close::operator()(void* library) const {
    dlclose(library);
}

}  // namespace pliant
