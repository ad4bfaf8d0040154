void f() { const Eigen::Isometry3d map_T_base = map_T_odom * (*odom_T_base_[i]).inverse(); this->T_w_c_ = Sophus::SE3d(T_w_b.matrix().cast<double>() * m_T_b_c); }
