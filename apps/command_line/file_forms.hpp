// The kinds of files that commands write, and how an existing file is known to be one.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace foresight {

/// An output takes the place of an existing file only where that is of the output's own form, or empty.
struct FileForm {
  std::string name;                               ///< "a page of foresight"
  std::function<bool(std::string_view text)> is;  ///< `text`: the file's first and last 4 KiB
  /// It carries our mark: such a file in a folder of inputs (a run, pictures) is an earlier output, not one of them.
  bool marked = false;
};

FileForm numbers_form();      ///< JSON: --json, --report of replay, *.plots.json
FileForm page_form();         ///< HTML reports
FileForm result_form();       ///< calibration/result/result_file.hpp
FileForm camera_info_form();  ///< scene/camera_info.hpp
FileForm can_log_form();      ///< drivers/can/candump_log.hpp
FileForm joint_log_form();    ///< session/joint_log.hpp
FileForm board_form();        ///< calibration/target/print_board.hpp
FileForm model_form();        ///< scene/gltf_writer.hpp, both kinds
FileForm png_form();
FileForm picture_form();  ///< PNG or JPEG
FileForm svg_form();
/// A part that belongs to the file `whole` (the .bin of a .gltf): ours where that is.
FileForm part_form(std::filesystem::path whole, const FileForm& form_of_whole);

/// Whether the regular file is empty or of that form. False where it cannot be read.
bool has_form(const std::filesystem::path& file, const FileForm& form);

}  // namespace foresight
