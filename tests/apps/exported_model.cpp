#include "tests/apps/exported_model.hpp"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace foresight {
namespace {

/// glTF's y up to our z up.
Eigen::Vector3d z_up(const Eigen::Vector3d& p) {
  return {p.x(), -p.z(), p.y()};
}

Eigen::Matrix4d matrix(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column) out(row, column) = static_cast<double>(m[row][column]);
  return out;
}

cv::Mat read_texture(const aiScene& scene, const std::filesystem::path& folder) {
  aiString name;
  if (scene.mMaterials[0]->GetTexture(aiTextureType_BASE_COLOR, 0, &name) != AI_SUCCESS)
    throw std::runtime_error("no base colour texture");
  const aiTexture* embedded = scene.GetEmbeddedTexture(name.C_Str());
  if (!embedded) return cv::imread(folder / name.C_Str());
  return cv::imdecode(cv::Mat(1, static_cast<int>(embedded->mWidth), CV_8U, embedded->pcData), cv::IMREAD_COLOR);
}

}  // namespace

ExportedModel::ExportedModel(const std::filesystem::path& file) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, 0);
  if (!scene) throw std::runtime_error(importer.GetErrorString());
  atlas = read_texture(*scene, file.parent_path());
  for (unsigned m = 0; m < scene->mNumMaterials; ++m) {
    int value = 0;
    scene->mMaterials[m]->Get(AI_MATKEY_TWOSIDED, value);
    two_sided |= value != 0;
    aiShadingMode shading{};
    unlit |=
        scene->mMaterials[m]->Get(AI_MATKEY_SHADING_MODEL, shading) == AI_SUCCESS && shading == aiShadingMode_Unlit;
  }
  std::vector<std::pair<const aiNode*, Eigen::Matrix4d>> open{
      {scene->mRootNode, matrix(scene->mRootNode->mTransformation)}};
  while (!open.empty()) {
    const auto [node, T] = open.back();
    open.pop_back();
    for (unsigned i = 0; i < node->mNumChildren; ++i)
      open.emplace_back(node->mChildren[i], T * matrix(node->mChildren[i]->mTransformation));
    if (node == scene->mRootNode) continue;
    Pose pose;
    for (int c = 0; c < 3; ++c) pose.linear().col(c) = z_up(T.block<3, 1>(0, c));
    pose.translation() = z_up(T.block<3, 1>(0, 3));
    T_world_node[node->mName.C_Str()] = pose;
    for (unsigned m = 0; m < node->mNumMeshes; ++m) {
      const aiMesh& mesh = *scene->mMeshes[node->mMeshes[m]];
      triangles_of_node[node->mName.C_Str()] += mesh.mNumFaces;
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        Triangle& triangle = triangles.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
          const unsigned v = mesh.mFaces[f].mIndices[i];
          const aiVector3D p = mesh.mVertices[v], t = mesh.mTextureCoords[0][v];
          triangle[i].p_world = pose * Eigen::Vector3d(p.x, p.y, p.z);
          triangle[i].uv = {t.x, 1.0 - static_cast<double>(t.y)};  // assimp counts from the bottom
        }
      }
    }
  }
}

Eigen::Vector3d ExportedModel::colour(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d at = uv.cwiseProduct(Eigen::Vector2d(atlas.cols, atlas.rows)) - Eigen::Vector2d(0.5, 0.5);
  const Eigen::Vector2d base = at.array().floor(), part = at - base;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) {
    const int x = std::clamp(static_cast<int>(base.x()) + (i & 1), 0, atlas.cols - 1);
    const int y = std::clamp(static_cast<int>(base.y()) + (i >> 1), 0, atlas.rows - 1);
    const cv::Vec3b c = atlas.at<cv::Vec3b>(y, x);
    sum += (i & 1 ? part.x() : 1 - part.x()) * (i >> 1 ? part.y() : 1 - part.y()) * Eigen::Vector3d(c[0], c[1], c[2]);
  }
  return sum;
}

ExportedModel::Picture ExportedModel::picture(const Lens& lens, const Pose& T_world_camera) const {
  Picture out{cv::Mat(lens.height(), lens.width(), CV_8UC3, cv::Scalar::all(0)),
              cv::Mat(lens.height(), lens.width(), CV_64F, cv::Scalar(0))};
  const Eigen::Vector3d eye = T_world_camera.translation();
  for (int y = 0; y < lens.height(); ++y)
    for (int x = 0; x < lens.width(); ++x) {
      const auto ray = lens.unproject({x, y});
      if (!ray) continue;
      const Eigen::Vector3d d = T_world_camera.linear() * *ray;
      double nearest = 1e300;
      for (const Triangle& t : triangles) {  // Moeller and Trumbore 1997
        const Eigen::Vector3d ab = t[1].p_world - t[0].p_world, ac = t[2].p_world - t[0].p_world, p = d.cross(ac);
        const double determinant = ab.dot(p);
        if (std::abs(determinant) < 1e-15) continue;
        const Eigen::Vector3d s = eye - t[0].p_world, q = s.cross(ab);
        const double b = s.dot(p) / determinant, c = d.dot(q) / determinant, distance = ac.dot(q) / determinant;
        if (b < 0 || c < 0 || b + c > 1 || distance < 0.01 || distance >= nearest) continue;
        nearest = distance;
        out.inverse_z.at<double>(y, x) = 1 / (distance * ray->z());
        const Eigen::Vector3d bgr = colour((1 - b - c) * t[0].uv + b * t[1].uv + c * t[2].uv);
        for (int i = 0; i < 3; ++i) out.bgr.at<cv::Vec3b>(y, x)[i] = cv::saturate_cast<uchar>(bgr[i]);
      }
    }
  return out;
}

}  // namespace foresight
