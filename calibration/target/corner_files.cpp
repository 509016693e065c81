#include "calibration/target/corner_files.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "calibration/target/corner_tables.hpp"
#include "calibration/target/view_names.hpp"
#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

bool is_vnl(const fs::path& path) {
  require_there(path);
  return !fs::is_directory(path);
}

const Board& needed(const std::optional<Board>& board, const fs::path& file) {
  if (!board)
    throw InputError(file.string(), "does not say what the board looks like", "give --board KIND:COLSxROWS:SIZE_M");
  return *board;
}

void require_views(const CornerSet& set, const std::string& where) {
  if (set.views.empty())
    throw InputError(where, "shows the board in no image", "give corners of at least four points an image");
}

std::vector<fs::path> csv_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw InputError(folder.string(), "holds no .csv file", "give a folder of <ns>.csv, one a view");
  return files;
}

/// Points of all views by tag and corner, for an index that all views share.
class TagPoints {
 public:
  void add(const TagRow& row) {
    const auto [at, is_new] = points_.try_emplace({row.tag, row.corner}, row);
    if (!is_new && (at->second.p_board - row.p_board).norm() > kSamePlace)
      throw InputError(row.where,
                       "puts corner " + std::to_string(row.corner) + " of tag " + std::to_string(row.tag) +
                           " elsewhere on the board than " + at->second.where,
                       "write p_x p_y p_z in the frame of the board");
  }
  int index(const TagRow& row) const {
    return static_cast<int>(std::distance(points_.begin(), points_.find({row.tag, row.corner})));
  }
  std::vector<Eigen::Vector3d> positions() const {
    std::vector<Eigen::Vector3d> p;
    for (const auto& [key, row] : points_) p.push_back(row.p_board);
    return p;
  }

 private:
  static constexpr double kSamePlace = 1e-6;  // metres
  std::map<std::pair<long long, long long>, TagRow> points_;
};

struct TagView {
  fs::path file;
  std::vector<TagRow> rows;
};

std::vector<TagView> read_tag_views(const fs::path& folder, TagPoints& points) {
  std::vector<TagView> views;
  for (const fs::path& file : csv_files(folder)) {
    views.push_back({file, read_tag_table(file)});
    for (const TagRow& row : views.back().rows) points.add(row);
  }
  return views;
}

CornerSet indexed(const std::vector<TagView>& views, const TagPoints& points, const fs::path& folder) {
  CornerSet set;
  set.p_board = points.positions();
  for (const TagView& view : views) {
    BoardView shown{view.file.stem().string(), {}};
    std::map<int, const TagRow*> by_index;
    for (const TagRow& row : view.rows) {
      const auto [at, is_new] = by_index.try_emplace(points.index(row), &row);
      if (!is_new)
        throw InputError(row.where,
                         "repeats corner " + std::to_string(row.corner) + " of tag " + std::to_string(row.tag) +
                             " of " + at->second->where,
                         "keep one of the two");
    }
    for (const auto& [index, row] : by_index) shown.corners.push_back({index, row->pixel, 1});
    if (spans_a_plane(shown.corners)) set.views.push_back(std::move(shown));
  }
  require_views(set, folder.string());
  return set;
}

std::string nearest_stamps(const CornerSet& left, const CornerSet& right) {
  long long best = std::numeric_limits<long long>::max();
  for (const BoardView& a : left.views)
    for (const BoardView& b : right.views) {
      const auto s = parse_integer(a.name), t = parse_integer(b.name);
      if (s && t) best = std::min(best, std::abs(*s - *t));
    }
  return best == std::numeric_limits<long long>::max()
             ? ""
             : "; the nearest stamps differ by " + std::to_string(best) + " ns";
}

void require_pairs(const StereoCorners& pair, const std::string& where) {
  std::set<std::string> names;
  for (const BoardView& view : pair.left.views) names.insert(view.name);
  for (const BoardView& view : pair.right.views)
    if (names.contains(view.name)) return;
  throw InputError(where,
                   "holds no view of both cameras: left has " + in_quotes(pair.left.views.front().name) +
                       ", right has " + in_quotes(pair.right.views.front().name) +
                       nearest_stamps(pair.left, pair.right),
                   "give both files of a pair the same name but for left and right");
}

std::string short_name(const std::string& name, const std::map<std::string, int>& stems) {
  const std::string stem = fs::path(name).stem().string();
  return stems.at(stem) == 1 ? stem : name;
}

}  // namespace

bool spans_a_plane(const std::vector<Corner>& corners) {
  if (corners.size() < 4) return false;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Corner& corner : corners) mean += corner.pixel / static_cast<double>(corners.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Corner& corner : corners) spread += (corner.pixel - mean) * (corner.pixel - mean).transpose();
  return spread.determinant() > 1e-4 * spread.trace() * spread.trace();
}

CornerSet read_corners(const fs::path& path, const std::optional<Board>& board) {
  if (!is_vnl(path)) {
    if (fs::is_directory(path / "cam1") && fs::is_directory(path / "cam0"))
      throw InputError(path.string(), "holds two cameras",
                       "give " + (path / "cam0").string() + ", or calibrate stereo");
    const fs::path folder = fs::is_directory(path / "cam0") ? path / "cam0" : path;
    TagPoints points;
    const auto views = read_tag_views(folder, points);
    return indexed(views, points, folder);
  }
  CornerSet set;
  set.p_board = board_points(needed(board, path));
  std::map<std::string, int> stems;
  std::map<std::string, std::set<PairSide>> sides;
  auto images = read_vnl(path, set.p_board.size());
  for (VnlImage& image : images) {
    const SidedName name = split_side(image.name);
    if (name.side) sides[name.view].insert(*name.side);
    ++stems[fs::path(image.name).stem().string()];
  }
  for (const auto& [view, seen] : sides)
    if (seen.size() == 2)
      throw InputError(path.string(), "holds two cameras: left and right of " + in_quotes(view),
                       "give the rows of one camera, or calibrate stereo");
  for (VnlImage& image : images)
    if (spans_a_plane(image.corners)) set.views.push_back({short_name(image.name, stems), std::move(image.corners)});
  require_views(set, path.string());
  return set;
}

StereoCorners read_stereo_corners(const fs::path& path, const std::optional<Board>& board) {
  StereoCorners pair;
  if (!is_vnl(path)) {
    for (const char* camera : {"cam0", "cam1"})
      if (!fs::is_directory(path / camera))
        throw InputError(path.string(), std::string("has no folder ") + camera, "give a folder with cam0/ and cam1/");
    TagPoints points;
    const auto left = read_tag_views(path / "cam0", points);
    const auto right = read_tag_views(path / "cam1", points);
    pair = {indexed(left, points, path / "cam0"), indexed(right, points, path / "cam1")};
    require_pairs(pair, path.string());
    return pair;
  }
  pair.left.p_board = pair.right.p_board = board_points(needed(board, path));
  std::map<std::pair<PairSide, std::string>, std::string> seen;
  for (VnlImage& image : read_vnl(path, pair.left.p_board.size())) {
    const SidedName name = split_side(image.name);
    if (!name.side)
      throw InputError(at_line(path, image.line), in_quotes(image.name) + " says neither camera",
                       "name the images left.. and right.., or cam0.. and cam1..");
    const auto [at, is_new] = seen.try_emplace({*name.side, name.view}, image.name);
    if (!is_new)
      throw InputError(at_line(path, image.line),
                       in_quotes(image.name) + " is the same view of the same camera as " + in_quotes(at->second),
                       "give every view its own name");
    if (!spans_a_plane(image.corners)) continue;
    (*name.side == PairSide::left ? pair.left : pair.right).views.push_back({name.view, std::move(image.corners)});
  }
  for (const auto& [set, name] : {std::pair{&pair.left, "left"}, {&pair.right, "right"}})
    if (set->views.empty())
      throw InputError(path.string(), std::string("shows the board in no ") + name + " image",
                       "give the corners of both cameras");
  require_pairs(pair, path.string());
  return pair;
}

}  // namespace foresight
