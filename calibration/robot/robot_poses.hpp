// Robot poses from files, in the forms that robots and datasets write.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

struct NamedPose {
  std::string name;   ///< of its file or its row; empty where the row has none
  std::string where;  ///< "file:line", for messages
  Pose pose = Pose::Identity();
};

struct RobotPoses {
  std::vector<NamedPose> poses;
  std::vector<std::string> notes;  ///< what was taken for granted (millimetres)
};

enum class PoseUnit { automatic, metre, millimetre };

/// A folder with one file a pose (.yaml with x y z qx qy qz qw, or a 4x4 matrix as text), in natural order of their
/// names; or one text file: 16 numbers a line, 4 lines of 4 (blank lines and a leading count are passed over), or [name
/// or time] x y z qx qy qz qw. Blanks or commas between. Throws InputError naming file and line: another form, no rigid
/// matrix (a quaternion with w first is told), not finite. `unit`: automatic takes a median distance beyond 20 for
/// millimetres and says so.
RobotPoses read_robot_poses(const std::filesystem::path& path, PoseUnit unit);

/// The pose of each of `views`, by name (equal stems, else the number in them) where the poses have
/// names that fit, else by order. Throws InputError with both counts where the order does not fit.
struct MatchedPoses {
  std::vector<Pose> poses;
  std::string how;  ///< "by name", "by number" or "by order"
};
MatchedPoses match_poses(const std::vector<NamedPose>& poses, const std::vector<std::string>& images,
                         const std::vector<std::string>& views);

/// A text file's rows of fields, blanks, commas and brackets between; common/text_rows.hpp says what is passed over.
struct FieldRow {
  int line = 0;
  std::vector<std::string> fields;
};
std::vector<FieldRow> read_field_rows(const std::filesystem::path& file);

/// Orders "view2" before "view10".
bool natural_less(const std::string& a, const std::string& b);

}  // namespace foresight
