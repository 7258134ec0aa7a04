//! Rows: a type each, stamped where it is shown to the visitor.

/// Rows in the operation's own formats: maker, name, what is done to which input; in braces, what else there is to say.
macro_rules! rows {
    ($visitor:ident, $operation:ident: $(
        $maker:ident $name:literal |$argument:pat_param| $result:expr $(, $found:ty)? $(, {$($item:item)*})?;
    )+) => {$({
        enum Row {}

        impl $crate::Variant for Row {
            type Operation = $crate::op::$operation;
            type Given = $crate::OperationInput<Self>;
            type Found = $crate::row::found!($operation $(, $found)?);
            const NAME: &'static str = $name;
            const MAKER: $crate::Maker = $crate::Maker::$maker;
            $($($item)*)?

            #[inline(always)]
            fn given(input: $crate::OperationInput<Self>) -> Self::Given {
                input
            }

            #[inline(always)]
            fn apply($argument: Self::Given) -> Self::Found {
                $result
            }
        }

        $visitor.visit::<Row>();
    })+};
}

/// The operation's output, unless the row says otherwise.
macro_rules! found {
    ($operation:ident) => {
        <$crate::op::$operation as $crate::Operation>::Output
    };
    ($operation:ident, $found:ty) => {
        $found
    };
}

/// Rows in types of their own: maker, name, the input's conversion and its type, what is done and its type; in braces, what
/// else there is to say.
macro_rules! converted_rows {
    ($visitor:ident, $operation:ident: $(
        $maker:ident $(($crate_name:literal))? $name:literal |$input:pat_param| $given:expr => $given_type:ty,
        |$argument:pat_param| $result:expr => $found:ty $(, {$($item:item)*})?;
    )+) => {$({
        enum Row {}

        impl $crate::Variant for Row {
            type Operation = $crate::op::$operation;
            type Given = $given_type;
            type Found = $found;
            const NAME: &'static str = $name;
            const MAKER: $crate::Maker = $crate::Maker::$maker $(($crate_name))?;
            $($($item)*)?

            #[inline(always)]
            fn given($input: $crate::OperationInput<Self>) -> Self::Given {
                $given
            }

            #[inline(always)]
            fn apply($argument: Self::Given) -> Self::Found {
                $result
            }
        }

        $visitor.visit::<Row>();
    })+};
}

pub(crate) use {converted_rows, found, rows};
