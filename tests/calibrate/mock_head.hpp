// A mock lab's head that differs from its drawing, before tags on table and wall; sessions that it records.
#pragma once

#include <fmt/core.h>

#include <fstream>
#include <random>

#include "calibration/registration/calibrated_head.hpp"
#include "scene/run_writer.hpp"
#include "sim/pan_tilt_head.hpp"
#include "sim/run_files.hpp"
#include "sim/tag_room.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/registration/lab_head.hpp"

namespace foresight {

struct MockHead {
  static constexpr double kClockOffset = 0.013;  ///< t_encoder - t_camera, s
  static constexpr double kEncoderNoise = 1e-4;  ///< rad
  static constexpr double kGreyNoise = 2;

  MockHead() {
    const auto small = [](double a, double b, double c, double x, double y, double z) {
      return to_motion((Vector6d() << a, b, c, x, y, z).finished());
    };
    truth.T_world_pan = sim::T_world_head_foot() * small(0.006, -0.008, 0, 0.004, -0.003, 0.005);
    truth.T_pan_tilt.translate(Eigen::Vector3d(0.003, 0.001, 0.082));
    truth.T_pan_tilt.rotate(Eigen::AngleAxisd(-std::acos(-1.0) / 2 + 0.007, Eigen::Vector3d::UnitX()));
    truth.T_tilt_camera = lab_head().T_tilt_camera * small(0.005, -0.004, 0.009, 0.002, -0.004, 0.003);
    truth.pan = {1, 0.006, 0.0012};
    truth.tilt = {1, -0.004, 0.0008};
    truth.offset_s = kClockOffset;
  }

  static RobotTime at(double s) { return RobotTime{1'000'000'000} + seconds(s); }

  /// What the drives are told: `session` changes the way.
  static HeadAngles motors(int session, double t) {
    return {0.42 * std::sin(0.5 * t + session), 0.5 + 0.17 * std::sin(0.83 * t + 2 * session)};
  }

  /// Encoders of the motors at 100 Hz on their own clock, and the shafts behind their play.
  struct Encoders {
    std::vector<std::pair<RobotTime, HeadAngles>> rows;
    EncoderTrack shafts;
  };
  Encoders move(int session, double length_s) const {
    std::mt19937 random(static_cast<unsigned>(session));
    std::normal_distribution<double> noise(0, kEncoderNoise);
    EncoderTrack::Options all;
    all.kept_s = 1e9;
    Encoders out{{}, EncoderTrack(truth, all)};
    for (double t = -1; t < length_s + 1; t += 0.01) {
      const HeadAngles q = motors(session, t);
      const RobotTime encoder_time = at(t + kClockOffset);
      out.shafts.add(encoder_time, q);
      out.rows.emplace_back(encoder_time, HeadAngles{q.pan + noise(random), q.tilt + noise(random)});
    }
    return out;
  }

  cv::Mat picture(const Pose& T_world_left, bool right, unsigned seed) const {
    const Pose T = right ? Pose(T_world_left * sim::T_head_left_right()) : T_world_left;
    return room.picture(rays, T, kGreyNoise, seed);
  }

  /// A run as `foresight robot --record` writes it, with the joints beside it and tags.txt inside.
  void record(const std::filesystem::path& run, int session, int pairs, double every_s) const {
    std::filesystem::create_directories(run);
    RunWriter writer(run, lab_lens(), "left");
    writer.add_right_camera(lab_lens(), sim::T_head_left_right(), "right");
    Encoders encoders = move(session, pairs * every_s);
    std::ofstream joints(run.string() + "-joints.csv");
    joints << "time_s,shoulder,pan,tilt\n";
    for (const auto& [time, q] : encoders.rows)
      joints << fmt::format("{:.9f},0.1,{:.7f},{:.7f}\n", to_seconds(time - RobotTime{}), q.pan, q.tilt);
    for (int i = 0; i < pairs; ++i) {
      const RobotTime time = at(i * every_s);
      const Pose T = T_world_camera(truth, encoders.shafts.at(time).shafts);
      for (const bool eye : {false, true}) {
        const std::string name = RunWriter::image_name(eye, static_cast<std::uint64_t>(i));
        writer.write_image(name, picture(T, eye, static_cast<unsigned>(1000 * session + 2 * i + eye)));
        writer.add_image(eye, time, name);
      }
    }
    writer.flush();
    write_tags(run / "tags.txt", room.corners());
  }

  static void write_tags(const std::filesystem::path& file, const TagMap& map) {
    std::ofstream out(file);
    out << "# id corner x y z\n";
    for (const auto& [id, corners] : map)
      for (std::size_t c = 0; c < 4; ++c)
        out << fmt::format("{} {} {:.9f} {:.9f} {:.9f}\n", id, static_cast<int>(c), corners[c].x(), corners[c].y(),
                           corners[c].z());
  }

  sim::TagRoom room{sim::TagRoom::lab_tags()};
  cv::Mat rays = sim::TagRoom::corner_rays(lab_lens());
  HeadModel truth;
};

/// RMS over the image of how far points 1 m away are off.
inline double error_px(const Lens& lens, const Pose& truth, const Pose& found) {
  double square = 0;
  int count = 0;
  for (int v = 40; v < lens.height(); v += 80)
    for (int u = 40; u < lens.width(); u += 80) {
      const auto pixel = lens.project(found.inverse() * truth * *lens.unproject({u, v}));
      square += pixel ? (*pixel - Eigen::Vector2d(u, v)).squaredNorm() : 1e6;
      ++count;
    }
  return std::sqrt(square / count);
}
inline double error_px(const Pose& truth, const Pose& found) {
  return error_px(lab_lens(), truth, found);
}

}  // namespace foresight
