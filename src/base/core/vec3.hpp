// A point or direction in space; light enough to include everywhere.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace pliant {

struct Vec3 {
    double x = 0, y = 0, z = 0;

    double& operator[](std::size_t i) { return i == 0 ? x : (i == 1 ? y : z); }
    double operator[](std::size_t i) const { return i == 0 ? x : (i == 1 ? y : z); }

    Vec3& operator+=(const Vec3& b) { return x += b.x, y += b.y, z += b.z, *this; }
    Vec3& operator-=(const Vec3& b) { return x -= b.x, y -= b.y, z -= b.z, *this; }
    Vec3& operator*=(double s) { return x *= s, y *= s, z *= s, *this; }
    bool operator==(const Vec3&) const = default;
};

inline Vec3 operator+(Vec3 a, const Vec3& b) {
    return a += b;
}
inline Vec3 operator-(Vec3 a, const Vec3& b) {
    return a -= b;
}
inline Vec3 operator-(const Vec3& a) {
    return {-a.x, -a.y, -a.z};
}
inline Vec3 operator*(Vec3 a, double s) {
    return a *= s;
}
inline Vec3 operator*(double s, Vec3 a) {
    return a *= s;
}
inline Vec3 operator/(Vec3 a, double s) {
    return a *= 1 / s;
}
inline double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(const Vec3& a) {
    return std::sqrt(dot(a, a));
}
/// Precondition: not zero.
inline Vec3 unit(const Vec3& a) {
    return a / norm(a);
}
inline bool is_finite(const Vec3& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Axis-aligned box; empty until a point is added.
struct Box3 {
    Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL};
    Vec3 high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    void add(const Vec3& p) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (p[i] < low[i]) low[i] = p[i];
            if (p[i] > high[i]) high[i] = p[i];
        }
    }
    /// Boundary included, after widening by `margin`.
    [[nodiscard]] bool contains(const Vec3& p, double margin = 0) const {
        return p.x >= low.x - margin && p.y >= low.y - margin && p.z >= low.z - margin && p.x <= high.x + margin &&
               p.y <= high.y + margin && p.z <= high.z + margin;
    }
    [[nodiscard]] bool empty() const { return low.x > high.x; }
    [[nodiscard]] Vec3 size() const { return empty() ? Vec3{} : high - low; }
    [[nodiscard]] Vec3 center() const { return 0.5 * (low + high); }
    [[nodiscard]] double diagonal() const { return norm(size()); }
};

}  // namespace pliant
