// Programs that outlive their passes, with all that the driver has compiled for them since they were linked.
#pragma once

#include <epoxy/gl.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace foresight::gl {

/// Drivers compile a program when it is used first: Mesa's software renderer for up to a second. Whoever rehearses its
/// work, throws away what came of it and begins anew has the second one begin with the first one's programs.
///
/// A program that is handed on has the uniforms that it was left with. One thread; destroyed, and in use, while a
/// context of the programs' share group is current.
class KeptPrograms {
 public:
  /// While it lives, programs that this thread destroys stay in the store, and those that it makes are taken from
  /// there. Of several the newest counts.
  class Use {
   public:
    explicit Use(KeptPrograms& store);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    KeptPrograms* before_;
  };

  KeptPrograms() = default;
  KeptPrograms(const KeptPrograms&) = delete;
  KeptPrograms& operator=(const KeptPrograms&) = delete;
  ~KeptPrograms();

  /// The one in use on this thread, or null.
  static KeptPrograms* in_use();

  /// `sources`: all that the program was made of. Of several, the one that was kept last: as members are destroyed in
  /// the opposite order of their making, each gets its own again.
  std::optional<GLuint> take(const std::string& sources);
  void made(GLuint program, const std::string& sources) { sources_[program] = sources; }
  /// False: it was not made in use of this store, and is not kept.
  bool keep(GLuint program);

 private:
  std::map<GLuint, std::string> sources_;  // of programs that were made, or taken, and not kept yet
  std::map<std::string, std::vector<GLuint>> spares_;
};

}  // namespace foresight::gl
