// Where the project and the recorded data lie.
#pragma once

#include <filesystem>

namespace foresight {

/// The root of the source tree that these tests were built from.
std::filesystem::path source_folder();

/// The folder of recorded data: FORESIGHT_DATA, else ../shared/data beside the project. It may be absent: a test that
/// needs it skips and says so.
std::filesystem::path data_folder();

}  // namespace foresight
