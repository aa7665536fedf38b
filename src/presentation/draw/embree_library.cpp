#include "presentation/draw/embree_library.hpp"

namespace pliant::report {

EmbreeLibrary::EmbreeLibrary() : LoadedLibrary(PLIANT_EMBREE) {
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

}  // namespace pliant::report
