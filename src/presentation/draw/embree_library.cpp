#include "presentation/draw/embree_library.hpp"

namespace pliant::report {

EmbreeLibrary::EmbreeLibrary() : library_(name()) {
    library_.find("rtcNewDevice", new_device);
    library_.find("rtcReleaseDevice", release_device);
    library_.find("rtcGetDeviceError", get_device_error);
    library_.find("rtcNewScene", new_scene);
    library_.find("rtcReleaseScene", release_scene);
    library_.find("rtcSetSceneFlags", set_scene_flags);
    library_.find("rtcCommitScene", commit_scene);
    library_.find("rtcNewGeometry", new_geometry);
    library_.find("rtcSetNewGeometryBuffer", set_new_geometry_buffer);
    library_.find("rtcCommitGeometry", commit_geometry);
    library_.find("rtcAttachGeometry", attach_geometry);
    library_.find("rtcReleaseGeometry", release_geometry);
    library_.find("rtcIntersect1", intersect_1);
    library_.find("rtcOccluded8", occluded_8);
}

const char* EmbreeLibrary::name() {
    return PLIANT_EMBREE;
}

}  // namespace pliant::report
