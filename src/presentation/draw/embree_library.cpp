#include "presentation/draw/embree_library.hpp"

#include <dlfcn.h>

namespace pliant::report {

EmbreeLibrary::EmbreeLibrary() : handle_(dlopen(name(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) {
    find("rtcNewDevice", new_device);
    find("rtcReleaseDevice", release_device);
    find("rtcGetDeviceError", get_device_error);
    find("rtcNewScene", new_scene);
    find("rtcReleaseScene", release_scene);
    find("rtcSetSceneFlags", set_scene_flags);
    find("rtcCommitScene", commit_scene);
    find("rtcNewGeometry", new_geometry);
    find("rtcSetNewGeometryBuffer", set_new_geometry_buffer);
    find("rtcCommitGeometry", commit_geometry);
    find("rtcAttachGeometry", attach_geometry);
    find("rtcReleaseGeometry", release_geometry);
    find("rtcIntersect1", intersect_1);
    find("rtcOccluded8", occluded_8);
}

const char* EmbreeLibrary::name() {
    return PLIANT_EMBREE;
}

/// If one function is missing, none is used.
template <class Function>
void EmbreeLibrary::find(const char* name, Function& function) {
    if (handle_) function = reinterpret_cast<Function>(dlsym(handle_.get(), name));
    if (function == nullptr) handle_.reset();
}

void EmbreeLibrary::Close::operator()(void* library) const {
    dlclose(library);
}

}  // namespace pliant::report
