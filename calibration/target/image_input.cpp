#include "calibration/target/image_input.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "calibration/target/view_names.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"
#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr double kBlurred = 0.5;  // of the median sharpness

/// "9.png" before "10.png": digits count as numbers.
bool by_number(const fs::path& a, const fs::path& b) {
  const std::string s = a.filename().string(), t = b.filename().string();
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t i = 0, j = 0; i < s.size() && j < t.size();) {
    if (digit(s[i]) && digit(t[j])) {
      const auto number = [&](const std::string& text, std::size_t& at) {
        while (at < text.size() && text[at] == '0') ++at;
        const std::size_t begin = at;
        while (at < text.size() && digit(text[at])) ++at;
        return text.substr(begin, at - begin);
      };
      const std::string x = number(s, i), y = number(t, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else if (s[i] != t[j]) {
      return s[i] < t[j];
    } else {
      ++i, ++j;
    }
  }
  return s < t;
}

/// `work(i)` for every i below `count`, on all cores; the first exception is thrown on.
void for_all(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::atomic_flag failed;
  const auto run = [&] {
    for (std::size_t i; (i = next++) < count;) try {
        work(i);
      } catch (...) {
        if (!failed.test_and_set()) failure = std::current_exception();
        next = count;
      }
  };
  {
    std::vector<std::jthread> helpers;
    for (unsigned n = 1; n < std::min<std::size_t>(std::thread::hardware_concurrency(), count); ++n)
      helpers.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

cv::Mat read_grey(const fs::path& file) {
  return read_picture(file, PictureColours::grey);
}

std::vector<cv::Mat> some_images(const std::vector<fs::path>& files, std::size_t most) {
  std::vector<cv::Mat> greys;
  for (std::size_t i = 0; i < most && i < files.size(); ++i)
    greys.push_back(read_grey(files[i * files.size() / std::min(most, files.size())]));
  return greys;
}

struct Seen {
  fs::path file;
  cv::Size size;
  std::optional<FoundBoard> found;
};

std::vector<Seen> look_at(const std::vector<fs::path>& files, const Board& board, const LookingAt& looking) {
  std::vector<Seen> seen(files.size());
  std::mutex telling;
  std::size_t begun = 0;
  for_all(files.size(), [&](std::size_t i) {
    thread_local std::optional<std::pair<std::string, BoardFinder>> finder;
    const std::string text = to_string(board);
    if (!finder || finder->first != text) finder.emplace(text, BoardFinder(board));
    if (looking) {
      const std::lock_guard lock(telling);
      looking(files[i], begun++, files.size());
    }
    const cv::Mat grey = read_grey(files[i]);
    seen[i] = {files[i], grey.size(), finder->second.find(grey)};
  });
  for (const Seen& s : seen)
    if (s.size != seen.front().size) {
      const auto text = [](const Seen& of) {
        return std::to_string(of.size.width) + "x" + std::to_string(of.size.height);
      };
      throw InputError(s.file.string(),
                       "is " + text(s) + " px, " + seen.front().file.filename().string() + " is " + text(seen.front()),
                       "give images of one camera at one resolution");
    }
  return seen;
}

void require_found(const std::vector<Seen>& seen, const Board& board, const fs::path& folder) {
  if (std::any_of(seen.begin(), seen.end(), [](const Seen& s) { return s.found.has_value(); })) return;
  std::vector<fs::path> files;
  for (const Seen& s : seen) files.push_back(s.file);
  throw InputError(folder.string(),
                   "shows the board in none of " + counted(seen.size(), "image") + ": " +
                       explain_nothing_found(board, some_images(files, 3)),
                   "check --board against the print");
}

std::string not_found_text(const Board& board) {
  return board.kind == BoardKind::charuco || board.kind == BoardKind::apriltag ? "no part of the board found"
                                                                               : "the whole board was not found";
}

/// Sharpness below which an image counts as blurred, and the median.
struct BlurRule {
  explicit BlurRule(const std::vector<Seen>& seen) {
    std::vector<double> all;
    for (const Seen& s : seen)
      if (s.found) all.push_back(s.found->quality.sharpness);
    median = foresight::median(std::move(all));
  }
  bool blurred(const FoundBoard& found) const { return found.quality.sharpness < kBlurred * median; }
  std::string text(const FoundBoard& found) const {
    return "blurred: sharpness " + readable(found.quality.sharpness, 2) + ", median " + readable(median, 2);
  }
  double median = 0;
};

void start_set(CornerSet& set, const std::vector<Seen>& seen, const Board& board) {
  set.width = seen.front().size.width;
  set.height = seen.front().size.height;
  set.p_board = board_points(board);
}

Board completed(const Board& board, const std::vector<fs::path>& files) {
  if (board.kind != BoardKind::charuco || (!board.family.empty() && board.marker_m > 0)) return board;
  const Board complete = complete_board(board, some_images(files, 5));
  if (complete.family.empty())
    throw InputError(files.front().parent_path().string(), "shows no marker of any dictionary that has enough of them",
                     "check that the board is a ChArUco board, or name its dictionary in --board");
  return complete;
}

using Pairs = std::vector<std::pair<std::string, std::array<std::optional<std::size_t>, 2>>>;

/// Views of both cameras by their common name, in the left files' order.
Pairs pair_up(const std::vector<fs::path>& left, const std::vector<fs::path>& right) {
  Pairs pairs;
  std::map<std::string, std::size_t> at;
  const auto add = [&](const std::vector<fs::path>& files, std::size_t side) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      const std::string name = split_side(files[i].filename().string()).view;
      const auto [entry, is_new] = at.try_emplace(name, pairs.size());
      if (is_new) pairs.push_back({name, {}});
      auto& slot = pairs[entry->second].second[side];
      if (slot)
        throw InputError(files[i].string(), "is the same view as " + files[*slot].filename().string(),
                         "give every view its own number");
      slot = i;
    }
  };
  add(left, 0);
  add(right, 1);
  const bool any = std::any_of(pairs.begin(), pairs.end(), [](const auto& p) { return p.second[0] && p.second[1]; });
  if (any) return pairs;
  if (left.size() != right.size())
    throw InputError(left.front().parent_path().string(),
                     "has no image named like one of " + right.front().parent_path().string() + ", and " +
                         counted(left.size(), "image") + " beside " + std::to_string(right.size()),
                     "give both images of a pair the same name");
  Pairs in_order;
  for (std::size_t i = 0; i < left.size(); ++i)
    in_order.push_back({split_side(left[i].filename().string()).view, {i, i}});
  return in_order;
}

}  // namespace

std::vector<fs::path> list_images(const fs::path& folder) {
  std::vector<fs::path> files;
  const std::string pattern = folder.filename().string();
  const bool by_pattern = !fs::is_directory(folder) && pattern.find_first_of("*?[") != std::string::npos;
  const fs::path where = by_pattern ? (folder.has_parent_path() ? folder.parent_path() : fs::path(".")) : folder;
  if (!fs::is_directory(where)) throw InputError(where.string(), "is no folder", "give a folder of images");
  for (const auto& entry : fs::directory_iterator(where)) {
    const bool wanted = !by_pattern || fnmatch(pattern.c_str(), entry.path().filename().c_str(), FNM_PERIOD) == 0;
    if (wanted && names_picture(entry.path()) && entry.is_regular_file()) files.push_back(entry.path());
  }
  if (files.empty())
    throw InputError(folder.string(), by_pattern ? "names no image" : "holds no image",
                     "give png, jpg, bmp, pgm or tif files");
  std::sort(files.begin(), files.end(), by_number);
  return files;
}

std::vector<std::array<fs::path, 2>> list_pairs(const fs::path& left, const fs::path& right) {
  const auto left_files = list_images(left), right_files = list_images(right);
  std::vector<std::array<fs::path, 2>> out;
  for (const auto& [name, files] : pair_up(left_files, right_files))
    if (files[0] && files[1]) out.push_back({left_files[*files[0]], right_files[*files[1]]});
  return out;
}

FoundCorners find_in_folder(const fs::path& folder, const Board& board, const LookingAt& looking) {
  return find_in_files(list_images(folder), board, looking);
}

FoundCorners find_in_files(const std::vector<fs::path>& files, const Board& board, const LookingAt& looking) {
  FoundCorners result;
  result.board = completed(board, files);
  const auto seen = look_at(files, result.board, looking);
  require_found(seen, result.board, files.front().parent_path());
  start_set(result.corners, seen, result.board);
  const BlurRule blur(seen);
  for (const Seen& s : seen) {
    const std::string name = s.file.filename().string();
    if (!s.found) {
      result.dropped.push_back({name, not_found_text(board)});
    } else if (blur.blurred(*s.found)) {
      result.dropped.push_back({name, blur.text(*s.found)});
    } else {
      result.corners.views.push_back({s.file.stem().string(), s.found->corners});
      result.files[result.corners.views.back().name] = {s.file, {}};
    }
  }
  return result;
}

FoundStereoCorners find_pairs_in_folders(const fs::path& left, const fs::path& right, const Board& board,
                                         const LookingAt& looking) {
  const auto left_files = list_images(left), right_files = list_images(right);
  const Pairs pairs = pair_up(left_files, right_files);
  FoundStereoCorners result;
  result.board = completed(board, left_files);
  auto left_seen = look_at(left_files, result.board, looking);
  auto right_seen = look_at(right_files, result.board, looking);
  require_found(left_seen, result.board, left);
  require_found(right_seen, result.board, right);
  start_set(result.corners.left, left_seen, result.board);
  start_set(result.corners.right, right_seen, result.board);
  const BlurRule left_blur(left_seen), right_blur(right_seen);
  bool any = false;
  for (const auto& [name, files] : pairs) {
    Seen* sides[2] = {files[0] ? &left_seen[*files[0]] : nullptr, files[1] ? &right_seen[*files[1]] : nullptr};
    bool blurred = false;
    for (int i = 0; i < 2; ++i) {
      if (!sides[i]) {
        result.dropped.push_back({name, std::string("no ") + (i == 0 ? "left" : "right") + " image of this name"});
      } else if (!sides[i]->found) {
        result.dropped.push_back({sides[i]->file.filename().string(), not_found_text(board)});
      } else if (const BlurRule& rule = i == 0 ? left_blur : right_blur; rule.blurred(*sides[i]->found)) {
        result.dropped.push_back({sides[i]->file.filename().string(), rule.text(*sides[i]->found)});
        blurred = true;
      }
    }
    if (blurred) continue;
    const bool both = sides[0] && sides[1] && sides[0]->found && sides[1]->found;
    any = any || both;
    if (both) align_order(result.board, *sides[0]->found, *sides[1]->found);
    for (int i = 0; i < 2; ++i) {
      if (!sides[i] || !sides[i]->found) continue;
      (i == 0 ? result.corners.left : result.corners.right).views.push_back({name, sides[i]->found->corners});
      result.files[name][static_cast<std::size_t>(i)] = sides[i]->file;
    }
  }
  if (!any)
    throw InputError(left.string(), "and " + right.string() + " show the board in no pair",
                     "see that both cameras see the board at once, and that the names of a pair agree");
  return result;
}

}  // namespace foresight
