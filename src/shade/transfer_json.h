// transfer_json.h: transfer functions as JSON values, in files of their own and in records of pictures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "vog/value_transfer.h"

namespace vog::shading {

/// Transfer function of vog's JSON, or ParaView's.
/// where   file or key with ": ", for messages
/// throws  vog::Error naming the key
TransferPoints points_of(const nlohmann::json& json, const std::string& where);
/// Name of a map, or vog's JSON.
nlohmann::ordered_json points_json(const TransferPoints& points);

}  // namespace vog::shading
