// Embree, loaded when the first picture is drawn: it is large, most runs do not need it, and loading it takes longer
// than everything else before main.
#pragma once

#include <embree3/rtcore.h>

#include <memory>

namespace pliant::report {

/// The functions in use, by their names in Embree; either all are present, or none. Once loaded the library stays in
/// the process, so that further objects cost nothing.
class EmbreeLibrary {
public:
    EmbreeLibrary();
    EmbreeLibrary(const EmbreeLibrary&) = delete;
    EmbreeLibrary& operator=(const EmbreeLibrary&) = delete;
    [[nodiscard]] bool is_there() const { return handle_ != nullptr; }
    /// File name of the library.
    [[nodiscard]] static const char* name();

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

private:
    template <class Function>
    void find(const char* name, Function& function);
    struct Close {
        void operator()(void* library) const;
    };
    std::unique_ptr<void, Close> handle_;
};

}  // namespace pliant::report
