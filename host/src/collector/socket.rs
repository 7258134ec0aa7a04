//! The collector's UDP socket.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};

use socket2::{Domain, Protocol, Socket, Type};

/// Room for the packets of a whole fleet while the host is busy; the system may grant less.
const RECEIVE_BUFFER: usize = 8 << 20;

/// Why the collector cannot listen.
#[derive(Debug, thiserror::Error)]
pub enum BindError {
    /// Somebody else does.
    #[error(
        "UDP port {0} is taken, perhaps by another collector: choose another with --port, or --port 0 for any free one"
    )]
    Taken(u16),
    /// Anything else.
    #[error("cannot listen on UDP port {port} (choose another with --port)")]
    Other {
        /// The port.
        port: u16,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
}

/// Binds `address` and `port` (0: any free one).
pub fn bind(address: Ipv4Addr, port: u16) -> Result<UdpSocket, BindError> {
    let open = || -> io::Result<UdpSocket> {
        let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
        socket.set_recv_buffer_size(RECEIVE_BUFFER)?;
        socket.bind(&SocketAddr::from((address, port)).into())?;
        Ok(socket.into())
    };
    open().map_err(|cause| match cause.kind() {
        io::ErrorKind::AddrInUse => BindError::Taken(port),
        _ => BindError::Other { port, cause },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_taken_port_is_named_with_the_way_out() {
        let first = bind(Ipv4Addr::LOCALHOST, 0).expect("any free port");
        let port = first.local_addr().expect("it is bound").port();
        let message = bind(Ipv4Addr::LOCALHOST, port)
            .expect_err("it is taken")
            .to_string();
        assert!(
            message.contains(&port.to_string()) && message.contains("--port"),
            "{message}"
        );
    }
}
