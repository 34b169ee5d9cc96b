// camera_fuzz.cpp: Reader of cameras; what is read is written and read again, and makes finite rays.
#include <cmath>

#include "fuzz_target.h"
#include "vog/camera.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".json");
    Camera camera;
    if (!accepted([&] { camera = read_camera(file); })) return;
    const CameraFrame frame = frame_of(camera, 16, 9);
    const Vec3d ray = frame.direction(15, 8);
    expect(std::isfinite(dot(ray, ray)), "rays are finite");
    const std::filesystem::path again_file = scratch_file("again.json");
    Camera again;
    expect(accepted([&] { write_camera(again_file, camera); }), "a camera that is read is written");
    expect(accepted([&] { again = read_camera(again_file); }), "a camera that is written is read");
    expect(again == camera, "a camera survives bit for bit");
}

}  // namespace vog::fuzz
