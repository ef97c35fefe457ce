#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/ros/ros_link.hpp"
#include "idl/ros_types.hpp"

namespace collided::ros {

/// Writes contacts as visualization_msgs/MarkerArray: marker 0 of "contacts" has their points, marker 1 of "depths" a
/// line from each along its normal. Without contacts both are deleted. False where a reader takes no more.
bool write_contacts(dds::Writer<MarkerArray>& writer, const std::vector<ShownContact>& contacts,
                    const std::string& frame, std::int64_t stamp_ns);

}  // namespace collided::ros
