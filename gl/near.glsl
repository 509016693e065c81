const float kNear = 0.01;  // gl::kNearPlane; depth buffers hold kNear / z, 0 where no model is
