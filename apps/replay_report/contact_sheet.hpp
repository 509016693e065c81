// One picture that tells a run: a row per instant with the delayed, predicted and actual image and
// the error of the prediction.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "apps/replay_report/instants.hpp"

namespace foresight {

/// CV_8UC3, `width` px wide (at least 640). `title`: one line of ASCII. Empty `instants` give a
/// sheet that says so.
cv::Mat draw_contact_sheet(const std::string& title, std::span<const Instant> instants, int width = 1920);

/// Draws the sheet and writes it as PNG, atomically. Throws RuntimeFailure naming `file` and the cure.
void write_contact_sheet(const std::string& title, std::span<const Instant> instants,
                         const std::filesystem::path& file);

}  // namespace foresight
