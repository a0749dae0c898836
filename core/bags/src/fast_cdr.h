// What Fast CDR 1.x and 2.x name differently. Both write and read plain CDR, as ROS 2 has it: 2.x calls it XCDRv1.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/config.h>

#include <cstddef>
#include <cstdint>

namespace rigproof::fast_cdr {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

#if FASTCDR_VERSION_MAJOR >= 2
constexpr auto kPlainCdr = eprosima::fastcdr::CdrVersion::XCDRv1;
inline std::size_t written_bytes(const Cdr& cdr) { return cdr.get_serialized_data_length(); }
inline const char* position(Cdr& cdr) { return cdr.get_current_position(); }
inline void write_bytes(Cdr& cdr, const std::uint8_t* bytes, std::size_t count) { cdr.serialize_array(bytes, count); }
#else
constexpr auto kPlainCdr = Cdr::DDS_CDR;
inline std::size_t written_bytes(const Cdr& cdr) { return cdr.getSerializedDataLength(); }
inline const char* position(Cdr& cdr) { return cdr.getCurrentPosition(); }
inline void write_bytes(Cdr& cdr, const std::uint8_t* bytes, std::size_t count) { cdr.serializeArray(bytes, count); }
#endif

}  // namespace rigproof::fast_cdr
