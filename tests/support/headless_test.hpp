// Fixture of all tests that need OpenGL.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "common/error.hpp"
#include "gl/context.hpp"

namespace foresight {

/// A fresh headless context for each test; skips where this machine has no OpenGL 4.5.
class HeadlessTest : public testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = gl::create_headless_context();
      driver_ = gl::query_driver();
    } catch (const RuntimeFailure& failure) {
      GTEST_SKIP() << failure.what();
    }
    gl::set_up_context();
  }
  void TearDown() override {
    if (context_) gl::check_errors("the test");
  }

  std::unique_ptr<gl::Context> context_;
  gl::DriverInfo driver_;
};

}  // namespace foresight
