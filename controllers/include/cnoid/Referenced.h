// Objects that count their owners, and the smart pointers for them.
//
// A Referenced is deleted when its last ref_ptr is destroyed. Raw pointers of the API are borrowed: to use one after
// the call, store a ref_ptr (BodyPtr, LinkPtr, DevicePtr ...) instead. Counting is safe from several threads; making
// and locking a weak_ref_ptr is not.
#pragma once

#include "Config.h"

#include <atomic>
#include <cassert>
#include <cstddef>
#include <functional>
#include <memory>
#include <ostream>
#include <utility>

namespace cnoid {

template <class T>
class ref_ptr;
template <class T>
class weak_ref_ptr;

class CNOID_GENERAL_EXPORT Referenced {
 public:
  virtual ~Referenced();

 protected:
  Referenced() = default;
  /// A copy starts without owners.
  Referenced(const Referenced&) {}
  Referenced& operator=(const Referenced&) { return *this; }

 private:
  template <class T>
  friend class ref_ptr;
  template <class T>
  friend class weak_ref_ptr;

  void addRef() const { owners_.fetch_add(1, std::memory_order_relaxed); }
  void releaseRef() const {
    if (owners_.fetch_sub(1, std::memory_order_acq_rel) == 1) delete this;
  }
  void releaseRefWithoutDeleting() const { owners_.fetch_sub(1, std::memory_order_acq_rel); }

  /// Records for weak pointers whether this object still exists; made for the first weak pointer.
  const std::shared_ptr<bool>& life() const {
    if (!life_) life_ = std::make_shared<bool>(true);
    return life_;
  }

  mutable std::atomic<int> owners_{0};
  mutable std::shared_ptr<bool> life_;
};

/// Owns a T that derives from Referenced. Converts from and to T* without a cast, as the API's sources expect.
template <class T>
class ref_ptr {
 public:
  using element_type = T;

  ref_ptr() = default;
  ref_ptr(T* object) : object_(object) {
    if (object_) object_->addRef();
  }
  ref_ptr(const ref_ptr& other) : ref_ptr(other.object_) {}
  template <class U>
  ref_ptr(const ref_ptr<U>& other) : ref_ptr(static_cast<T*>(other.get())) {}
  ref_ptr(ref_ptr&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  ~ref_ptr() {
    if (object_) object_->releaseRef();
  }

  ref_ptr& operator=(const ref_ptr& other) {
    ref_ptr(other).swap(*this);
    return *this;
  }
  ref_ptr& operator=(ref_ptr&& other) noexcept {
    ref_ptr(std::move(other)).swap(*this);
    return *this;
  }
  template <class U>
  ref_ptr& operator=(const ref_ptr<U>& other) {
    ref_ptr(other).swap(*this);
    return *this;
  }
  ref_ptr& operator=(T* object) {
    ref_ptr(object).swap(*this);
    return *this;
  }

  void reset() { ref_ptr().swap(*this); }
  void reset(T* object) { ref_ptr(object).swap(*this); }

  T* get() const { return object_; }
  operator T*() const { return object_; }
  T& operator*() const {
    assert(object_);
    return *object_;
  }
  T* operator->() const {
    assert(object_);
    return object_;
  }

  /// Releases the object without deleting it: for a function that returns a new object by raw pointer.
  T* retn() {
    if (object_) object_->releaseRefWithoutDeleting();
    return std::exchange(object_, nullptr);
  }

  void swap(ref_ptr& other) noexcept { std::swap(object_, other.object_); }

 private:
  T* object_ = nullptr;
};

using ReferencedPtr = ref_ptr<Referenced>;

template <class T, class U>
bool operator==(const ref_ptr<T>& a, const ref_ptr<U>& b) {
  return a.get() == b.get();
}
template <class T, class U>
bool operator!=(const ref_ptr<T>& a, const ref_ptr<U>& b) {
  return a.get() != b.get();
}
template <class T, class U>
bool operator==(const ref_ptr<T>& a, U* b) {
  return a.get() == b;
}
template <class T, class U>
bool operator!=(const ref_ptr<T>& a, U* b) {
  return a.get() != b;
}
template <class T, class U>
bool operator==(T* a, const ref_ptr<U>& b) {
  return a == b.get();
}
template <class T, class U>
bool operator!=(T* a, const ref_ptr<U>& b) {
  return a != b.get();
}
/// Compares addresses: for containers only. An order of addresses differs from run to run.
template <class T>
bool operator<(const ref_ptr<T>& a, const ref_ptr<T>& b) {
  return std::less<T*>()(a.get(), b.get());
}

template <class T>
void swap(ref_ptr<T>& a, ref_ptr<T>& b) noexcept {
  a.swap(b);
}

template <class T, class U>
ref_ptr<T> static_pointer_cast(const ref_ptr<U>& pointer) {
  return static_cast<T*>(pointer.get());
}
template <class T, class U>
ref_ptr<T> const_pointer_cast(const ref_ptr<U>& pointer) {
  return const_cast<T*>(pointer.get());
}
/// Null if the object is not a T.
template <class T, class U>
ref_ptr<T> dynamic_pointer_cast(const ref_ptr<U>& pointer) {
  return dynamic_cast<T*>(pointer.get());
}

template <class T>
std::ostream& operator<<(std::ostream& os, const ref_ptr<T>& pointer) {
  return os << pointer.get();
}

/// Refers to an object without owning it.
template <class T>
class weak_ref_ptr {
 public:
  using element_type = T;

  weak_ref_ptr() = default;
  weak_ref_ptr(T* object) : object_(object) {
    if (object_) life_ = object_->life();
  }
  template <class U>
  weak_ref_ptr(const ref_ptr<U>& pointer) : weak_ref_ptr(static_cast<T*>(pointer.get())) {}
  template <class U>
  weak_ref_ptr(const weak_ref_ptr<U>& other) : weak_ref_ptr(static_cast<T*>(other.lock().get())) {}

  /// The object, or null if it was deleted.
  ref_ptr<T> lock() const { return life_ && *life_ ? ref_ptr<T>(object_) : ref_ptr<T>(); }
  /// True if the pointer referred to an object that was deleted.
  bool expired() const { return life_ && !*life_; }
  void reset() { *this = weak_ref_ptr(); }
  explicit operator bool() const { return object_ != nullptr; }

  friend bool operator==(const weak_ref_ptr& a, const weak_ref_ptr& b) { return a.life_ == b.life_; }
  friend bool operator<(const weak_ref_ptr& a, const weak_ref_ptr& b) { return a.life_ < b.life_; }

 private:
  T* object_ = nullptr;
  std::shared_ptr<bool> life_;
};

}  // namespace cnoid

template <class T>
struct std::hash<cnoid::ref_ptr<T>> {
  std::size_t operator()(const cnoid::ref_ptr<T>& pointer) const { return std::hash<T*>()(pointer.get()); }
};
