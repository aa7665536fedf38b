// Embree, loaded when the first picture is drawn: a large library, which most runs of the program do without, and whose
// loading takes longer than all else before main.
#pragma once

#include <embree3/rtcore.h>

#include <memory>

namespace pliant::report {

/// The functions that are used, by their names there; all are there, or none. Once loaded it stays in the program, so
/// that the next one of these costs nothing.
class EmbreeLibrary {
public:
    EmbreeLibrary();
    EmbreeLibrary(const EmbreeLibrary&) = delete;
    EmbreeLibrary& operator=(const EmbreeLibrary&) = delete;
    [[nodiscard]] bool is_there() const { return handle_ != nullptr; }
    /// Of the file that is looked for.
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
