#include "simulation/material/point.hpp"

namespace pliant::material {

Matrix3 cofactor(const Matrix3& F) {
    Matrix3 C;
    C.col(0) = F.col(1).cross(F.col(2));
    C.col(1) = F.col(2).cross(F.col(0));
    C.col(2) = F.col(0).cross(F.col(1));
    return C;
}

}  // namespace pliant::material
