//! The types of a scene as it is written.

/// Declares them: an object refuses keys that it does not know, and leaves out a field of an `Option` without a value;
/// a choice is written with hyphens.
macro_rules! specs {
    () => {};
    ($(#[$about:meta])* pub enum $name:ident { $($variants:tt)* } $($others:tt)*) => {
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        $(#[$about])*
        pub enum $name { $($variants)* }
        specs! { $($others)* }
    };
    ($(#[$about:meta])* pub struct $name:ident { $($fields:tt)* } $($others:tt)*) => {
        specs! { @fields [$(#[$about])* pub struct $name] {} $($fields)* }
        specs! { $($others)* }
    };
    (@fields [$($head:tt)*] {$($fields:tt)*}) => {
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        $($head)* { $($fields)* }
    };
    (@fields $head:tt {$($fields:tt)*} $(#[$about:meta])* pub $name:ident: Option<$of:ty>, $($others:tt)*) => {
        specs! { @fields $head {
            $($fields)*
            $(#[$about])* #[serde(skip_serializing_if = "Option::is_none")] pub $name: Option<$of>,
        } $($others)* }
    };
    (@fields $head:tt {$($fields:tt)*} $(#[$about:meta])* pub $name:ident: $of:ty, $($others:tt)*) => {
        specs! { @fields $head { $($fields)* $(#[$about])* pub $name: $of, } $($others)* }
    };
}
