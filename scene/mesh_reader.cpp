#include "scene/mesh_reader.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/DefaultIOSystem.h>
#include <algorithm>
#include <assimp/Importer.hpp>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/collada_check.hpp"
#include "scene/files.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/ply_reader.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

// A mesh file may name others (buffers, materials). They must lie beside or beneath it: a mesh
// from elsewhere shall not make the program read whatever it names.
class BesideTheMesh : public Assimp::DefaultIOSystem {
 public:
  explicit BesideTheMesh(const fs::path& mesh) : folder_(fs::weakly_canonical(mesh).parent_path()) {}

  Assimp::IOStream* Open(const char* name, const char* mode) override {
    std::error_code error;
    const fs::path path = fs::weakly_canonical(name, error);
    const bool inside = std::mismatch(folder_.begin(), folder_.end(), path.begin(), path.end()).first == folder_.end();
    if (error || !inside || !fs::is_regular_file(path, error)) return nullptr;
    return DefaultIOSystem::Open(name, mode);
  }

 private:
  fs::path folder_;
};

class AssimpScene {
 public:
  AssimpScene(const fs::path& file, const aiScene& scene) : file_(file), scene_(scene) {}

  Mesh mesh() {
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> open = {{scene_.mRootNode, {}}};
    while (!open.empty()) {  // a loop: files decide how deep nodes nest
      const auto [node, T_parent] = open.back();
      open.pop_back();
      const aiMatrix4x4 T = T_parent * node->mTransformation;
      for (unsigned i = 0; i < node->mNumMeshes; ++i) add(*scene_.mMeshes[node->mMeshes[i]], T);
      for (unsigned i = node->mNumChildren; i-- > 0;) open.emplace_back(node->mChildren[i], T);
    }
    if (!any_face_) throw InputError(file_.string(), "has no faces", "export a triangle mesh");
    return std::move(builder_).take();
  }

 private:
  void add(const aiMesh& mesh, const aiMatrix4x4& T) {
    std::vector<Eigen::Vector3f> points;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D p = T * mesh.mVertices[i];
      points.emplace_back(p.x, p.y, p.z);
      if (!points.back().allFinite())
        throw InputError(file_.string(),
                         "mesh " + in_quotes(mesh.mName.C_Str()) + ": vertex " + std::to_string(i) + " is not finite",
                         "remove the vertex or repair the mesh");
    }
    std::vector<Eigen::Vector3f> corners;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) continue;  // points and lines
      corners.clear();
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        if (face.mIndices[k] >= points.size())
          throw InputError(
              file_.string(),
              "face " + std::to_string(f) + ": vertex index " + std::to_string(face.mIndices[k]) + " is out of range",
              "export the mesh again");
        corners.push_back(points[face.mIndices[k]]);
      }
      builder_.add(corners);
      any_face_ = true;
    }
  }

  const fs::path& file_;
  const aiScene& scene_;
  MeshBuilder builder_;
  bool any_face_ = false;
};

Mesh read_through_assimp(const fs::path& file) {
  Assimp::Importer importer;
  importer.SetIOHandler(new BesideTheMesh(file));  // owned by the importer
  // Robot descriptions expect Collada meshes as written, as other URDF readers show them.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = nullptr;
  std::string reason;
  try {
    scene = importer.ReadFile(file.string(), aiProcess_ValidateDataStructure);
    reason = importer.GetErrorString();
  } catch (const std::exception& error) {
    reason = error.what();
  }
  if (!scene || !scene->mRootNode)
    throw InputError(file.string(), "cannot be read as a mesh (" + reason + ")", "export the mesh again");
  return AssimpScene(file, *scene).mesh();
}

}  // namespace

Mesh read_mesh(const fs::path& file) {
  static const std::vector<std::string> kKnown = {".ply", ".obj", ".stl", ".gltf", ".glb", ".dae"};
  require_regular_file(file, kLargestMesh);
  const std::string extension = lower(file.extension().string());
  if (std::find(kKnown.begin(), kKnown.end(), extension) == kKnown.end())
    throw InputError(file.string(), "unknown kind of mesh " + in_quotes(extension),
                     "convert it to one of .ply .obj .stl .gltf .glb .dae");
  if (extension == ".dae") check_collada(file);
  Mesh mesh = extension == ".ply" ? read_ply(file) : read_through_assimp(file);
  if (mesh.triangles.empty())
    throw InputError(file.string(), "none of its faces has an area", "export the mesh again, in metres");
  return mesh;
}

}  // namespace foresight
