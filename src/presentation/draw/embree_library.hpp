// Embree, loaded when the first picture is drawn.
#pragma once

#include <embree3/rtcore.h>

#include "base/core/loaded_library.hpp"

namespace pliant::report {

/// The functions in use, by their names in Embree.
class EmbreeLibrary : public LoadedLibrary {
public:
    EmbreeLibrary();

    decltype(&rtcNewDevice) new_device = nullptr;
    decltype(&rtcReleaseDevice) release_device = nullptr;
    decltype(&rtcGetDeviceError) get_device_error = nullptr;
    decltype(&rtcNewScene) new_scene = nullptr;
    decltype(&rtcReleaseScene) release_scene = nullptr;
    decltype(&rtcSetSceneFlags) set_scene_flags = nullptr;
    decltype(&rtcCommitScene) commit_scene = nullptr;
    decltype(&rtcNewGeometry) new_geometry = nullptr;
    decltype(&rtcSetNewGeometryBuffer) set_new_geometry_buffer = nullptr;
    decltype(&rtcCommitGeometry) commit_geometry = nullptr;
    decltype(&rtcAttachGeometry) attach_geometry = nullptr;
    decltype(&rtcReleaseGeometry) release_geometry = nullptr;
    decltype(&rtcIntersect1) intersect_1 = nullptr;
    decltype(&rtcOccluded8) occluded_8 = nullptr;
};

}  // namespace pliant::report
