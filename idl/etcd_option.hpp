#pragma once

namespace collided::etcd {

/// The option by which every program takes the folder.
inline constexpr const char* kEtcdKeysFlag = "--etcd-keys";
inline constexpr const char* kEtcdKeysVariable = "COLLIDED_ETCD_KEYS";
inline constexpr const char* kEtcdKeysHelp =
    "folder for etcds://, as Kubernetes mounts its secrets: ca.crt, tls.crt and tls.key, username and password";

}  // namespace collided::etcd
