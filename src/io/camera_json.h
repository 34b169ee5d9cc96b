// camera_json.h: cameras as JSON objects, in files of their own and in records of pictures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "vog/camera.h"

namespace vog {

/// Camera of an object with the keys of read_camera.
/// where   file or key, for messages
/// throws  vog::Error as read_camera does
Camera camera_of(const nlohmann::ordered_json& json, const std::string& where);
nlohmann::ordered_json camera_json(const Camera& camera);

}  // namespace vog
