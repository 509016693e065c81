// Fixture of all tests that need OpenGL.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "common/error.hpp"
#include "gl/context.hpp"

namespace foresight {

/// A fresh headless context for each test, so that no state is left of the one before; skips where this machine has no
/// OpenGL 4.5. All contexts of a suite share one device, which is opened once: that takes longer than most tests.
class HeadlessTest : public testing::Test {
 public:
  static void TearDownTestSuite() { device_.reset(); }

 protected:
  void SetUp() override {
    try {
      if (!device_) device_ = gl::create_headless_context();
      context_ = device_->create_shared();
      context_->make_current();
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

 private:
  static inline std::unique_ptr<gl::Context> device_;  // never drawn to
};

}  // namespace foresight
