// Files written here are read by assimp, which knows nothing of ours.
#include "scene/gltf_writer.hpp"

#include <assimp/material.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <nlohmann/json.hpp>

#include "scene/mesh_reader.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::gltf_writer_test {
namespace {

GltfModel model() {
  GltfModel out;
  out.generator = "a test";
  Pose pose = Pose::Identity();
  pose.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()));
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  out.nodes.push_back(
      {"a \"name\"\n\xff", pose, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5F}}, {{0, 0}, {1, 0}, {0, 0.25F}}, {{0, 1, 2}}});
  out.nodes.push_back({"only a pose", Pose::Identity(), {}, {}, {}});
  out.nodes.push_back({"second",
                       Pose::Identity(),
                       {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {1, 1, 2}},
                       {{0, 0}, {1, 0}, {0, 1}, {1, 1}},
                       {{0, 1, 2}, {1, 3, 2}}});
  cv::Mat picture(2, 3, CV_8UC3, cv::Scalar(10, 20, 30));
  out.png = encoded(".png", picture);
  return out;
}

void expect_model(const std::filesystem::path& file) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, 0);
  ASSERT_TRUE(scene) << importer.GetErrorString();
  ASSERT_EQ(scene->mRootNode->mNumChildren, 3u);
  EXPECT_EQ(scene->mNumMeshes, 2u);
  // World (1, 2, 3) with z up is (1, 3, -2) with y up.
  const aiNode& first = *scene->mRootNode->mChildren[0];
  const aiVector3D origin = scene->mRootNode->mTransformation * first.mTransformation * aiVector3D(0, 0, 0);
  EXPECT_LT((origin - aiVector3D(1, 3, -2)).Length(), 1e-5F);
  const Eigen::Vector3d p = model().nodes[0].T_world_node * Eigen::Vector3d(0, 1, 0.5);
  const aiVector3D corner = scene->mRootNode->mTransformation * first.mTransformation * scene->mMeshes[0]->mVertices[2];
  EXPECT_LT(
      (corner - aiVector3D(static_cast<ai_real>(p.x()), static_cast<ai_real>(p.z()), static_cast<ai_real>(-p.y())))
          .Length(),
      1e-5F);
  EXPECT_EQ(scene->mRootNode->mChildren[1]->mNumMeshes, 0u);
  EXPECT_EQ(scene->mMeshes[1]->mNumFaces, 2u);
  EXPECT_NEAR(1 - scene->mMeshes[0]->mTextureCoords[0][2].y, 0.25, 1e-6) << "assimp counts from the bottom";
  aiString texture;
  EXPECT_EQ(scene->mMaterials[0]->GetTexture(aiTextureType_BASE_COLOR, 0, &texture), AI_SUCCESS);
}

TEST(GltfWriter, OneFileHoldsEverything) {
  const TempFolder folder;
  const std::string bytes = to_glb(model());
  EXPECT_EQ(bytes.size() % 4, 0u);
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  const auto file = folder.write("model.glb", bytes);
  expect_model(file);
  EXPECT_EQ(read_mesh(file).triangles.size(), 3u) << "our own reader";
}

TEST(GltfWriter, ThreeFilesNameEachOther) {
  const TempFolder folder;
  const GltfFiles files = to_gltf(model(), "my_model.bin", "my_model.png");
  folder.write("my_model.bin", files.bin);
  folder.write("my_model.png", model().png);
  expect_model(folder.write("my_model.gltf", files.gltf));
  const auto json = nlohmann::json::parse(files.gltf);
  EXPECT_EQ(json["images"][0]["uri"], "my_model.png");
  EXPECT_EQ(json["extensionsUsed"], nlohmann::json::array({"KHR_materials_unlit"}));
  EXPECT_EQ(json["buffers"][0]["byteLength"], files.bin.size());
  for (const auto& view : json["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<int>() % 4, 0);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), files.bin.size());
  }
}

// As the specification wants it; assimp 5.2 does not decode it.
TEST(GltfWriter, NamesBecomeUris) {
  const auto json = nlohmann::json::parse(to_gltf(model(), "a b.bin", "50% #1, a.png").gltf);
  EXPECT_EQ(json["buffers"][0]["uri"], "a%20b.bin");
  EXPECT_EQ(json["images"][0]["uri"], "50%25%20%231%2C%20a.png");
}

}  // namespace
}  // namespace foresight::gltf_writer_test
