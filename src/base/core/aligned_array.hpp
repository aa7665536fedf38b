// Large arrays for SIMD.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace pliant {

/// Aligned to cache lines and uninitialised: the system maps each page at its first write. Large arrays request huge
/// pages, because faulting in small pages may cost more time than the work that fills them.
template <class T>
class AlignedArray {
    static_assert(std::is_trivial_v<T>);

public:
    AlignedArray() = default;
    explicit AlignedArray(std::size_t size) { resize(size); }
    AlignedArray(AlignedArray&& other) noexcept
        : values_(std::move(other.values_)), size_(std::exchange(other.size_, 0)) {}
    AlignedArray& operator=(AlignedArray&& other) noexcept {
        values_ = std::move(other.values_);
        size_ = std::exchange(other.size_, 0);
        return *this;
    }

    /// Contents are lost if the size changes. Throws std::bad_alloc.
    void resize(std::size_t size) {
        if (size == size_) return;
        values_.reset();
        size_ = 0;
        if (size == 0) return;
        constexpr std::size_t huge = std::size_t{2} << 20;
        const std::size_t bytes = size * sizeof(T);
        const std::size_t alignment = bytes >= huge ? huge : 64;
        const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
        values_.reset(static_cast<T*>(std::aligned_alloc(alignment, whole)));
        if (!values_) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        if (alignment == huge) madvise(values_.get(), whole, MADV_HUGEPAGE);
#endif
        size_ = size;
    }
    [[nodiscard]] std::size_t size() const {
        return size_;
    }
    [[nodiscard]] T* data() const {
        return values_.get();
    }
    [[nodiscard]] std::span<T> span() const {
        return {data(), size_};
    }
    [[nodiscard]] T& operator[](std::size_t i) const {
        return values_[i];
    }

private:
    struct Free {
        void operator()(T* values) const { std::free(values); }
    };
    std::unique_ptr<T[], Free> values_;
    std::size_t size_ = 0;
};

}  // namespace pliant
