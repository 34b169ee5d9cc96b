// vog/request_schema.h: Members of a picture's request as front ends offer them: options, keywords, and keys of JSON.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/picture.h"

namespace vog {

/// A member of PictureRequest. Names of members in texts stand between backquotes, which a front end spells its own way.
struct RequestMember {
    std::string key;      ///< "least_column"
    std::string group;    ///< heading of a help: "Quantity"
    std::string takes;    ///< values of a command line: "LO,HI"; empty: a flag or one of `choices`
    std::string text;     ///< meaning, unit, default
    std::string unset{};  ///< default in a word, "512x512"; empty: the text states it
    std::vector<std::string> choices{};  ///< words, where there are no other values
    std::string shows{};      ///< quantities that it changes, "mean deviation"; empty: all
    std::string renderers{};  ///< renderers that have it, "trace optix"; empty: all
    bool many = false;        ///< a list of rows, each an option of its own
    bool verbatim = false;    ///< any text, in which numbers and commas have no meaning
};

/// All members but the camera, in the order of a help.
std::span<const RequestMember> request_schema();

/// An option that has an effect only beside some values of another one: of requests, where options are members, and of conversions.
struct OptionRule {
    std::string members;  ///< keys, "tf range"; "scale=symmetric": only this value
    std::string beside;   ///< key of the other one; "shadows light=studio": one of these
    std::string values;   ///< "mean deviation"; "*": not its default; "-": its default
    std::string of{};  ///< quantities, or conversions, that the rule is for, "volume"; empty: all
};
/// Rules between members, beside those of `shows` and `renderers`. General reasons stand first.
std::span<const OptionRule> request_rules();

/// Sets a member from the words of a command line: numbers with commas between them, words, sizes such as 640x480, colours by
/// name; of `tf` also files.
/// words   one, or one for each row; of flags "true"
/// throws  RequestError for words that are none of its values, vog::Error for files of `tf` that cannot be read
void set_member(PictureRequest& request, const std::string& key,
                const std::vector<std::string>& words);

}  // namespace vog
