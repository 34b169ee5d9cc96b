// vog/picture_record.h: How a picture was made, as the picture itself keeps it: JSON in PNG and EXR files.
//   {"vog": "1.2.0", "inputs": ["smoke.vdb"], "reading": {"--grid": ["density"]}, "picture": {"show": "volume", ...}}
// The keys of "picture" are the words of `vog render` and of Python's vog.render; members at their defaults are left out.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "vog/picture.h"

namespace vog {

/// Members of a request that are not at their defaults, as a JSON object: by the keys of request_schema(), and "camera".
std::string request_json(const PictureRequest& request);
/// Request of a JSON object with these keys; null stands for the default.
/// base    members that the object does not state
/// throws  RequestError for an unknown key, another type, and numbers out of range
PictureRequest request_of_json(const std::string& json, const PictureRequest& base = {});

/// throws  RequestError for a member that changes nothing of the quantity that is shown
void require_effects(const PictureRequest& request);

/// How a picture was made.
struct PictureRecord {
    PictureRequest request;
    std::vector<std::string> inputs;  ///< files as they were named
    std::map<std::string, std::vector<std::string>>
        reading{};          ///< options that these were read with
    std::string version{};  ///< version of vog that wrote it
};
/// Text for the writers of vog/image.h.
std::string record_json(const PictureRecord& record);
/// Record of its JSON, or of a request's, which names no inputs.
/// throws  vog::Error for text that is no record, and as request_of_json does
PictureRecord record_of_json(const std::string& json);
/// Record of a page's link (docs/web.md): its members of a request, without the page's own words; it names no inputs.
/// link    "https://example.org/page.html#show=column&tf=viridis&camera.eye=1,2,3"; counts from its first '#'
/// throws  RequestError for another word, and as request_of_json does
PictureRecord record_of_link(const std::string& link);
/// Record of a JSON file, a file with a page's link, or a PNG or EXR picture. Reads no other file.
/// throws  vog::Error naming the file, also for a picture without a record
PictureRecord read_record(const std::filesystem::path& file);

}  // namespace vog
