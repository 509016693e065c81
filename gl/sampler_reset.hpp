// What keeps Mesa's software renderers from compiling compute programs again and again.
//
// Version 22.3 compiles a variant of a program for each set of sampler states, and takes in the places of buffer
// textures, which have none: there is left what a program before had in the same place. So one that filters images may
// cost a fifth of a second for each that runs after it for the first time, in the middle of a session.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace foresight::gl {

/// One context. Nothing on other renderers.
class SamplerReset {
 public:
  SamplerReset();  ///< and resets: what no program has had yet is a state of its own

  /// After compute programs that filter images: all places are as those leave them that do not. Another program is
  /// current then, and another texture bound to the last unit.
  void operator()() const;

 private:
  Program program_;
  Texture texture_;
};

}  // namespace foresight::gl
