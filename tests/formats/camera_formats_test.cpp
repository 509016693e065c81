#include "calibration/formats/camera_formats.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "common/error.hpp"
#include "tests/formats/example_cameras.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::camera_formats_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr CameraFormat kAll[] = {CameraFormat::camera_info, CameraFormat::kalibr, CameraFormat::opencv,
                                 CameraFormat::mrcal};
constexpr Distortion kModels[] = {Distortion::radtan4, Distortion::radtan5, Distortion::rational,
                                  Distortion::thin_prism, Distortion::equidistant};

// What each format can hold, as their own documents say.
bool holds(CameraFormat format, Distortion model) {
  if (model == Distortion::equidistant) return format != CameraFormat::mrcal;
  if (format == CameraFormat::kalibr) return model == Distortion::radtan4;
  return format != CameraFormat::camera_info || model != Distortion::thin_prism;
}

TEST(CameraFormats, EveryFormatReadsBackOrRefuses) {
  const TempFolder folder;
  for (const CameraFormat format : kAll)
    for (const Distortion model : kModels)
      for (const bool pair : {false, true}) {
        CalibratedCameras cameras = example_pair(model);
        if (!pair) cameras.cameras.pop_back();
        const std::string name = to_string(format) + "_" + to_string(model) + (pair ? "_pair" : "");
        const auto path = folder / name;
        const auto write = [&] { return write_cameras(format, cameras, path, false); };
        if (!holds(format, model)) {
          EXPECT_THAT(input_error(write), AllOf(HasSubstr("cannot hold " + to_string(model)), HasSubstr("opencv")))
              << name;
          EXPECT_FALSE(std::filesystem::exists(path)) << name;
          continue;
        }
        const ExportSummary summary = write();
        EXPECT_EQ(summary.rays, 1000);
        EXPECT_LT(summary.worst_px, 1e-9) << name;
        const bool in_files = format == CameraFormat::camera_info || format == CameraFormat::mrcal;
        EXPECT_EQ(summary.files.size(), pair && in_files ? 2u : 1u);
        const CalibratedCameras back = read_cameras(format, path);
        EXPECT_EQ(back.pair(), pair);
        EXPECT_LT(worst_ray(cameras, back, 500), 1e-9) << name;
      }
}

TEST(CameraFormats, OpenCvWritesXmlAndJsonToo) {
  const TempFolder folder;
  for (const char* name : {"pair.xml", "pair.json", "pair.yml"}) {
    write_cameras(CameraFormat::opencv, example_pair(Distortion::rational), folder / name, false);
    EXPECT_LT(worst_ray(example_pair(Distortion::rational), read_cameras(CameraFormat::opencv, folder / name), 100),
              1e-9);
  }
  EXPECT_THAT(folder.read("pair.xml"), HasSubstr("<M1"));
  EXPECT_THAT(folder.read("pair.json"), HasSubstr("\"M1\""));
}

TEST(CameraFormats, KeepsWhatIsThere) {
  const TempFolder folder;
  const auto file = folder.write("camchain.yaml", "mine");
  const CalibratedCameras cameras = example_pair(Distortion::radtan4);
  EXPECT_THAT(input_error([&] { write_cameras(CameraFormat::kalibr, cameras, file, false); }), HasSubstr("--force"));
  EXPECT_EQ(folder.read("camchain.yaml"), "mine");
  write_cameras(CameraFormat::kalibr, cameras, file, true);
  EXPECT_THAT(folder.read("camchain.yaml"), HasSubstr("T_cn_cnm1"));
}

TEST(CameraFormats, RaysTellSmallDifferences) {
  const CalibratedCameras a = example_pair(Distortion::radtan4);
  CalibratedCameras b = a;
  EXPECT_LT(worst_ray(a, b, 1000), 1e-12);
  b.cameras[0].lens[0] += 1e-4;
  EXPECT_NEAR(worst_ray(a, b, 1000), 1e-4 * 341 / 533, 3e-5);
  b = a;
  b.T_left_right.translation().x() += 1e-6;
  EXPECT_NEAR(worst_ray(a, b, 1000), 1e-6 * 533 / 0.3, 5e-4) << "seen best by the nearest point";
  b = a;
  b.cameras[1].width = 320;
  EXPECT_TRUE(std::isinf(worst_ray(a, b, 10)));
}

// Left camera at the origin, right one 0.1 m to its right: what the others write for it.
TEST(CameraFormats, SignsAreThoseOfTheOtherPrograms) {
  const TempFolder folder;
  CalibratedCameras cameras = example_pair(Distortion::radtan4);
  cameras.T_left_right = Pose::Identity();
  cameras.T_left_right.translation().x() = 0.125;
  write_cameras(CameraFormat::kalibr, cameras, folder / "k.yaml", false);
  EXPECT_THAT(folder.read("k.yaml"), HasSubstr("- [1, 0, 0, -0.125]"));
  write_cameras(CameraFormat::opencv, cameras, folder / "o.yml", false);
  EXPECT_THAT(folder.read("o.yml"), HasSubstr("-1.2500000000000000e-01"));
  write_cameras(CameraFormat::mrcal, cameras, folder / "m", false);
  EXPECT_THAT(folder.read("m/right.cameramodel"), HasSubstr("[0, 0, 0, -0.125, 0, 0]"));
  write_cameras(CameraFormat::camera_info, cameras, folder / "c", false);
  EXPECT_THAT(folder.read("c/camera_right.yaml"), HasSubstr("xyz: [0.125, 0, 0]"));
}

TEST(CameraFormats, ReadsKalibrAsKalibrWritesIt) {
  const TempFolder folder;
  const auto file = folder.write("c.yaml", R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0008, 0.0001]
  distortion_model: radtan
  intrinsics: [461.6, 460.2, 362.7, 246.0]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [0.01, 0.0, 0.0, 0.0]
  distortion_model: equidistant
  intrinsics: [461.6, 460.2, 362.7, 246.0]
  resolution: [752, 480]
  timeshift_cam_imu: 0.01
)");
  const CalibratedCameras cameras = read_cameras(CameraFormat::kalibr, file);
  EXPECT_EQ(cameras.left().distortion, Distortion::radtan4);
  EXPECT_EQ(cameras.right().distortion, Distortion::equidistant);
  EXPECT_NEAR(cameras.T_left_right.translation().x(), 0.11, 1e-15);
}

TEST(CameraFormats, ReadsMrcalAsMrcalWritesIt) {
  const TempFolder folder;
  const auto file = folder.write("a.cameramodel", R"(# generated by somebody
{
    'lensmodel':  'LENSMODEL_OPENCV8',

    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....
    'intrinsics': [ 1761.18, 1761.25, 1965.7, 1087.5, -0.0126, -0.0035, -0.0004, 0.0001, 0.0, 0.21, 0.0, 0.0,],

    'valid_intrinsics_region': [ [ 0, 0 ],
    [ 0, 3000 ], ],

    'extrinsics': [ 0., 0.5, 0., 0.1, 0., 0. ],
    'imagersize': [ 4000, 2200 ],
    'icam_intrinsics': 0,
    'optimization_inputs': b'P)h>@6aWAK2mk;8{}Apmx#&:0{\\!|~',
}
)");
  const CameraModel camera = read_cameras(CameraFormat::mrcal, file).left();
  EXPECT_EQ(camera.distortion, Distortion::rational);
  EXPECT_EQ(camera.width, 4000);
  EXPECT_EQ(camera.lens[9], 0.21);
  const auto pinhole = folder.write(
      "p.cameramodel", "{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [1,2,3,4], 'imagersize': [10,20]}");
  EXPECT_EQ(read_cameras(CameraFormat::mrcal, pinhole).left().lens[1], 2);
}

TEST(CameraFormats, ReadsOpenCvsOwnExample) {
  const std::filesystem::path file = "/usr/share/doc/opencv-doc/examples/data/left_intrinsics.yml";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here; install opencv-doc";
  const CameraModel camera = read_cameras(CameraFormat::opencv, file).left();
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_NEAR(camera.lens[0], 535, 5);
}

TEST(CameraFormats, SaysWhatIsWrong) {
  const TempFolder folder;
  const auto message = [&](CameraFormat format, const std::string& text) {
    const auto file = folder.write("bad", text);
    return input_error([&] { read_cameras(format, file); });
  };
  EXPECT_THAT(message(CameraFormat::mrcal, "{'lensmodel': 'LENSMODEL_CAHVOR', 'intrinsics': [], 'imagersize': []}"),
              HasSubstr("mrcal-convert-lensmodel"));
  EXPECT_THAT(message(CameraFormat::mrcal, "{'lensmodel': 'LENSMODEL_OPENCV4', 'intrinsics': [1,2], 'imagersize': []}"),
              HasSubstr("intrinsics"));
  EXPECT_THAT(message(CameraFormat::mrcal, "words"), HasSubstr("bad"));
  EXPECT_THAT(message(CameraFormat::kalibr, "cam0: {camera_model: omni, distortion_model: radtan}"), HasSubstr("omni"));
  EXPECT_THAT(message(CameraFormat::kalibr, "cam1: {}"), HasSubstr("cam0"));
  EXPECT_THAT(message(CameraFormat::opencv, "%YAML:1.0\n---\nimage_width: 640\n"), HasSubstr("camera_matrix"));
  EXPECT_THAT(message(CameraFormat::opencv, "words and words"), HasSubstr("FileStorage"));
  EXPECT_THAT(message(CameraFormat::opencv, ""), HasSubstr("FileStorage"));
  EXPECT_THAT(message(CameraFormat::camera_info, "image_width: 640"), HasSubstr("image_height"));
  EXPECT_THAT(input_error([] { parse_camera_format("ros"); }), HasSubstr("known are camera-info"));
  EXPECT_THAT(input_error([&] { read_cameras(CameraFormat::mrcal, folder / "absent"); }), HasSubstr("absent"));
}

}  // namespace
}  // namespace foresight::camera_formats_test
